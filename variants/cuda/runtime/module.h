// A compiled set of kernels: sources, options and architecture in, launchable kernels out; kept on disk by a hash of
// all three.
#pragma once

#include <string>
#include <vector>

#include "variants/cuda/device/kernel_config.h"
#include "variants/cuda/runtime/check.h"
#include "variants/cuda_hooks.h"

namespace pt::cuda {

// What a module is compiled for. Everything that can change the code is in here, and so in the cache's key.
struct ModuleRequest {
    std::string name;                   // name of the module for messages
    std::vector<std::string> includes;  // embedded sources, in order, e.g. "variants/integrator/megakernel.cuh"
    std::string real = "float";
    std::string layout = "aos";
    std::string sort_key = "material";
    std::string accelerator = "brute_force";
    // Choices of the axes `traversal` and `traversal_stack` that run an accelerator's steps; empty: the accelerator's
    // own loop and stack.
    std::string traversal = "";
    std::string traversal_stack = "";
    std::string scene = "in_global";  // where the scene's arrays lie: variants/cuda/device/scene_*.cuh
    std::string pixels = "all";       // which pixels are rendered: variants/cuda/device/pixels_*.cuh
    KernelConfig config = {};
    std::vector<KernelConstant> constants = {};  // constants of the integrator that its kernels read as tuned::NAME
    std::vector<KernelSignature> kernels = {};   // kernels that the host launches
    std::vector<std::string> options = {};       // compiler options that the variant's choice of arithmetic needs
    std::string prelude = "";                    // source text with which the program begins
    std::string architecture;                    // "sm_90"
};

struct ModuleImage {
    std::string cubin;
    std::string key;                   // hash of sources, options and architecture, which names the cached module
    std::vector<std::string> options;  // options for NVRTC, then the config and constants in the program's text
    double compile_seconds = 0;
    bool from_cache = false;
};

// While an instance lives, programs that this process compiles take their common headers from a file that NVRTC has
// translated once (CUDA 12.8 and newer): a fifth of a program's time. For processes that compile several programs; one
// instance at a time.
class PrecompiledHeaders {
public:
    PrecompiledHeaders();
    ~PrecompiledHeaders();
    PrecompiledHeaders(const PrecompiledHeaders&) = delete;
    PrecompiledHeaders& operator=(const PrecompiledHeaders&) = delete;
};

// Compiles a module or takes it from the cache; a cache that cannot be written is done without. Throws CompileError
// with NVRTC's log if the source does not compile, std::runtime_error if a compilation is needed and NVRTC is missing.
ModuleImage build_module(const ModuleRequest& request);
// Compiles a module without looking into the cache or writing it.
ModuleImage compile_module(const ModuleRequest& request);

// Compiles a module as quickly as NVRTC can, almost without optimisation, for tests. What does not compile is refused
// as by compile_module, up to the assembler's limits of shared and constant memory.
ModuleImage compile_quickly(const ModuleRequest& request);

std::string module_key(const ModuleRequest& request);
// Whether the cache on disk has an undamaged image of the program.
bool is_cached(const ModuleRequest& request);

// The KernelConfig `config` as a C++ expression for a program's text.
std::string text_of(const KernelConfig& config);

class CompileError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

// The hash (FNV-1a, 16 hex digits) over all embedded sources and NVRTC's version.
std::string kernel_source_hash();
// The folder of compiled kernels: $XDG_CACHE_HOME/ptbench, or ~/.cache/ptbench.
std::string kernel_cache_folder();

// Resources that the compiler gave a kernel, per thread or per block.
struct KernelFacts {
    int registers = 0;             // registers of the kernel per thread
    std::size_t local_bytes = 0;   // local memory of the kernel per thread: spills and arrays
    std::size_t shared_bytes = 0;  // shared memory of the kernel per block
    int max_threads = 0;           // most threads of a block of the kernel
};

class Module {
public:
    explicit Module(const ModuleImage& image);
    ~Module();
    Module(const Module&) = delete;
    Module& operator=(const Module&) = delete;

    // Returns a kernel by its name. Throws Error if there is none of this name.
    cudaKernel_t kernel(const char* name) const;
    KernelFacts facts(const char* name) const;
    // The device address of a variable of the module. Throws Error if there is none of this name.
    void* global(const char* name) const;
    // Number of blocks of `threads` threads that one multiprocessor holds at once.
    int blocks_per_multiprocessor(const char* name, unsigned threads) const;
    const ModuleImage& image() const { return image_; }

    // Launches the kernel that has these parameters: the members of the struct are passed by value. Throws Error naming
    // the kernel.
    template <class Parameters>
    void launch(unsigned blocks, unsigned threads, cudaStream_t stream, const Parameters& parameters) const {
        static_assert(std::is_trivially_copyable_v<Parameters>);
        visit_members(parameters, [&](const auto&... member) {
            const void* pointers[] = {&member...};
            launch_pointers(Parameters::kernel, blocks, threads, stream, pointers);
        });
    }

private:
    void launch_pointers(const char* name, unsigned blocks, unsigned threads, cudaStream_t stream,
                         const void** parameters) const;

    ModuleImage image_;
    cudaLibrary_t library_ = nullptr;
};

}  // namespace pt::cuda
