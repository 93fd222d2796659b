#include "variants/cuda/runtime/module.h"

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include "variants/cuda/runtime/compiler_report.h"
#include "variants/cuda/runtime/nvrtc.h"
#include "variants/cuda/runtime/sources.h"
#include "variants/fnv1a.h"

namespace pt::cuda {

namespace fs = std::filesystem;

namespace {

// Standard headers that kernels and GLM include, replaced by texts that NVRTC can compile.
constexpr std::pair<const char*, const char*> shims[] = {
    {"cmath", "#include <cuda/std/cmath>\n"},
    {"cstdint", "#include <cuda/std/cstdint>\n"},
    {"cstddef", "#include <cuda/std/cstddef>\n"},
    {"limits", "#include <cuda/std/limits>\n"},
    {"type_traits", "#include <cuda/std/type_traits>\n"},
    {"utility", "#include <cuda/std/utility>\n"},
    {"array", "#include <cuda/std/array>\n"},
    {"cassert", ""},
    {"cfloat", ""},
    {"climits", "#include <cuda/std/climits>\n"},
};

// Extends a hash by a text and by a byte that no text contains, so that the borders between texts count.
std::uint64_t hash_text(std::string_view text, std::uint64_t start = fnv1a_start) {
    return fnv1a_step(fnv1a(text, start), 0xff);
}

std::uint64_t sources_hash() {
    static const std::uint64_t hash = [] {
        std::uint64_t h = hash_text(nvrtc_version());
        for (const EmbeddedSource& source : embedded_sources()) {
            h = hash_text(source.text, hash_text(source.name, h));
        }
        for (const auto& [name, text] : shims) {
            h = hash_text(text, hash_text(name, h));
        }
        return h;
    }();
    return hash;
}

fs::path cache_folder() {
    if (const char* xdg = std::getenv("XDG_CACHE_HOME"); xdg != nullptr && *xdg != '\0') {
        return fs::path(xdg) / "ptbench";
    }
    const char* home = std::getenv("HOME");
    return fs::path(home != nullptr ? home : "/tmp") / ".cache" / "ptbench";
}

std::string read_whole(const fs::path& path) {
    std::ifstream stream(path, std::ios::binary);
    std::ostringstream text;
    text << stream.rdbuf();
    return stream ? text.str() : std::string();
}

// Writes a file under a name of this process's own and then renames it, so that no two processes write to one file.
bool write_whole(const fs::path& path, std::string_view text) {
    std::error_code error;
    fs::create_directories(path.parent_path(), error);
    const fs::path partial = path.string() + fmt::format(".partial{}", ::getpid());
    std::ofstream stream(partial, std::ios::binary);
    stream.write(text.data(), static_cast<std::streamsize>(text.size()));
    stream.close();
    if (stream) {
        fs::rename(partial, path, error);
    }
    if (!stream || error) {
        fs::remove(partial, error);
        return false;
    }
    return true;
}

// Unpacks the sources, for NVRTC resolves GLM's relative includes only from files. A file that is there already is
// trusted only if it has the right text: it may be incomplete, or edited. Throws std::runtime_error.
fs::path unpacked_sources() {
    const fs::path folder = cache_folder() / fmt::format("include-{:016x}", sources_hash());
    static fs::path unpacked;  // folder unpacked last; another once XDG_CACHE_HOME has changed
    if (unpacked == folder) {
        return folder;
    }
    const auto put = [&](const fs::path& file, const std::string& text) {
        if (read_whole(file) != text && !write_whole(file, text)) {
            throw std::runtime_error(fmt::format("{}: cannot be written; set XDG_CACHE_HOME", file.string()));
        }
    };
    for (const EmbeddedSource& source : embedded_sources()) {
        put(folder / source.name, std::string(source.text));
    }
    for (const auto& [name, text] : shims) {
        put(folder / "shims" / name, fmt::format("#pragma once\n{}namespace cuda {{ namespace std {{}} }}\n"
                                                 "namespace std {{ using namespace cuda::std; }}\n",
                                                 text));
    }
    unpacked = folder;
    return folder;
}

// A cache entry is the cubin and, last, its hash: a damaged one is built again.
std::string from_cache(const fs::path& file) {
    const std::string entry = read_whole(file);
    if (entry.size() <= 16 ||
        entry.substr(entry.size() - 16) !=
            fmt::format("{:016x}", hash_text(std::string_view(entry).substr(0, entry.size() - 16)))) {
        return "";
    }
    return entry.substr(0, entry.size() - 16);
}

// The lines of a program's text that state, as constants, what the host has chosen.
std::vector<std::string> chosen(const ModuleRequest& request) {
    std::vector<std::string> lines{
        fmt::format("using Real = {};", request.real),
        fmt::format("inline constexpr pt::cuda::KernelConfig kernel_config{};", text_of(request.config))};
    for (const KernelConstant& constant : request.constants) {
        lines.push_back(
            fmt::format("namespace tuned {{ inline constexpr unsigned {} = {}u; }}", constant.name, constant.value));
    }
    return lines;
}

std::string traversal_text(const ModuleRequest& request) {
    const std::string own = fmt::format("pt::accelerator::{}::Traversal", request.accelerator);
    if (request.traversal.empty()) {
        return fmt::format("using Accelerator = {};\n", own);
    }
    return fmt::format(
        "#include \"variants/traversal/{0}.cuh\"\n"
        "#include \"variants/traversal_stack/{1}.cuh\"\n"
        "using Accelerator = pt::traversal::{0}::Traversal<{2}, pt::traversal_stack::{1}::Stack>;\n",
        request.traversal, request.traversal_stack, own);
}

// The text of a program for NVRTC: includes in order, and the names by which device code knows the variant's choices.
// What no choice changes comes first, up to the pragma that ends a precompiled header.
std::string program_text(const ModuleRequest& request) {
    std::string text =
        "#include \"kernels/shade.h\"\n"
        "#include \"variants/cuda/device/kernel_config.h\"\n"
        "#pragma nv_hdrstop\n";
    text += request.prelude;
    text += fmt::format("{}\n", fmt::join(chosen(request), "\n"));
    for (const KernelSignature& kernel : request.kernels) {
        text += fmt::format("namespace host_bytes {{ inline constexpr unsigned {} = {}u; }}\n", kernel.name,
                            kernel.parameter_bytes);
    }
    text += fmt::format(
        "#include \"variants/layout/{0}.cuh\"\n"
        "using Paths = pt::layout::{0}::DevicePaths<Real>;\n"
        "#include \"variants/accelerator/{3}.h\"\n"
        "{4}"
        "#include \"variants/cuda/device/scene_{2}.cuh\"\n"
        "#include \"variants/cuda/device/pixels_{5}.cuh\"\n"
        "#include \"variants/cuda/device/device.cuh\"\n"
        "#include \"variants/sort_key/{1}.cuh\"\n"
        "namespace sort_key = pt::sort_key::{1};\n",
        request.layout, request.sort_key, request.scene, request.accelerator, traversal_text(request), request.pixels);
    if (request.config.keeps_first_hits) {
        text += "#include \"variants/cuda/device/fill_cache.cuh\"\n";
    }
    for (const std::string& include : request.includes) {
        text += fmt::format("#include \"{}\"\n", include);
    }
    return text;
}

std::vector<std::string> options_of(const ModuleRequest& request) {
    std::vector<std::string> options{"-std=c++20",           "-default-device",
                                     "-DGLM_FORCE_CUDA",     "-DCUDA_VERSION=12080",
                                     "-diag-suppress=20012", "--gpu-architecture=" + request.architecture};
    options.insert(options.end(), request.options.begin(), request.options.end());
    return options;
}

// The options and the host's constants of a module, for results and messages.
std::vector<std::string> described_options(const ModuleRequest& request) {
    std::vector<std::string> described = options_of(request);
    for (std::string& line : chosen(request)) {
        described.push_back(std::move(line));
    }
    return described;
}

std::string key_of(const ModuleRequest& request, const std::vector<std::string>& options) {
    std::uint64_t key = hash_text(program_text(request), sources_hash());
    for (const std::string& option : options) {
        key = hash_text(option, key);
    }
    return fmt::format("{:016x}", key);
}

}  // namespace

std::string text_of(const KernelConfig& config) {
    std::string counts;
#define PT_COUNT(name, kind, word) counts += fmt::format(".{} = {}u, ", #name, config.counts.name);
    PT_OBJECT_ARRAYS(PT_COUNT)
#undef PT_COUNT
    return fmt::format(
        "{{.features = {}ull, .block = {}u, .min_blocks = {}u, .keeps_first_hits = {}, .shading_fmas = {}u, "
        ".constant_scene_bytes = {}u, .has_fixed_counts = {}, .counts = {{{}.walls = {}u, .lamps = {}u, .open_sides = "
        "{}u, .low_sides = {{{}u}}, .high_sides = {{{}u}}, .one_light = {}u}}}}",
        config.features, config.block, config.min_blocks, config.keeps_first_hits, config.shading_fmas,
        config.constant_scene_bytes, config.has_fixed_counts, counts, config.counts.walls, config.counts.lamps,
        config.counts.open_sides, fmt::join(config.counts.low_sides, "u, "), fmt::join(config.counts.high_sides, "u, "),
        config.counts.one_light);
}

std::string kernel_source_hash() { return fmt::format("{:016x}", sources_hash()); }

std::string kernel_cache_folder() { return cache_folder().string(); }

std::string module_key(const ModuleRequest& request) { return key_of(request, options_of(request)); }

bool is_cached(const ModuleRequest& request) {
    return !from_cache(cache_folder() / (module_key(request) + ".cubin")).empty();
}

namespace {

// Folder in which this process keeps precompiled headers, which are bound to its memory. Empty: it keeps none.
fs::path precompiled_folder;

std::vector<std::string> precompiled_options() {
    if (precompiled_folder.empty()) {
        return {};
    }
    // Diagnostic 629 is suppressed: it tells that the folder has a precompiled header made with other options, too.
    return {"-pch", "-pch-dir=" + precompiled_folder.string(), "-pch-messages=false", "-diag-suppress=629"};
}

}  // namespace

PrecompiledHeaders::PrecompiledHeaders() {
    int major = 0, minor = 0;
    const bool knows_them = std::sscanf(nvrtc_version().c_str(), "%d.%d", &major, &minor) == 2 &&
                            std::pair(major, minor) >= std::pair(12, 8);
    const fs::path folder = cache_folder() / fmt::format("headers.partial{}", ::getpid());
    std::error_code refused;
    if (knows_them && (fs::create_directories(folder, refused), !refused)) {
        precompiled_folder = folder;
    }
}

PrecompiledHeaders::~PrecompiledHeaders() {
    std::error_code ignored;
    if (!precompiled_folder.empty()) {
        fs::remove_all(precompiled_folder, ignored);
    }
    precompiled_folder.clear();
}

namespace {

// Compiles a module with more options than the request's own.
Compilation compiled(const ModuleRequest& request, const std::vector<std::string>& more_options) {
    if (const std::string missing = nvrtc_missing(); !missing.empty()) {
        throw std::runtime_error(missing);
    }
    std::vector<std::string> options = options_of(request);
    const fs::path include = unpacked_sources();
    options.push_back("-I" + include.string());
    options.push_back("-I" + (include / "shims").string());
    for (const std::vector<std::string>& more : {toolkit_include_options(), precompiled_options(), more_options}) {
        options.insert(options.end(), more.begin(), more.end());
    }
    Compilation compilation = compile(program_text(request), request.name + ".cu", options);
    if (!compilation.succeeded) {
        throw CompileError(fmt::format("{} does not compile for {} (options: {}):\n{}", request.name,
                                       request.architecture, fmt::join(described_options(request), " "),
                                       compilation.log));
    }
    return compilation;
}

ModuleImage image_of(const ModuleRequest& request, Compilation compilation) {
    ModuleImage image;
    image.options = described_options(request);
    image.key = module_key(request);
    image.cubin = std::move(compilation.cubin);
    image.compile_seconds = compilation.seconds;
    return image;
}

}  // namespace

ModuleImage compile_module(const ModuleRequest& request) { return image_of(request, compiled(request, {})); }

ModuleImage compile_quickly(const ModuleRequest& request) {
    // NVRTC before version 13 may not know the option -Ofc, for quick compilation.
    const bool knows = std::atoi(nvrtc_version().c_str()) >= 13;
    return image_of(request,
                    compiled(request, knows ? std::vector<std::string>{"-Ofc=max"} : std::vector<std::string>{}));
}

CompilerReport compiler_report(const ModuleRequest& request) {
    // NVRTC's own cache is bypassed, since a result from it has no report; versions before 13 do not know the option.
    std::vector<std::string> reporting{"--ptxas-options=-v"};
    if (std::atoi(nvrtc_version().c_str()) >= 13) {
        reporting.emplace_back("-no-cache");
    }
    Compilation compilation = compiled(request, reporting);
    return {.cubin = std::move(compilation.cubin),
            .kernels = parse_ptxas_log(compilation.log),
            .compile_seconds = compilation.seconds,
            .options = described_options(request)};
}

ModuleImage build_module(const ModuleRequest& request) {
    const auto start = std::chrono::steady_clock::now();
    ModuleImage image;
    image.options = described_options(request);
    image.key = module_key(request);
    const fs::path file = cache_folder() / (image.key + ".cubin");
    image.cubin = from_cache(file);
    if (!image.cubin.empty()) {
        image.from_cache = true;
        image.compile_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        return image;
    }
    image = compile_module(request);
    write_whole(file, image.cubin + fmt::format("{:016x}", hash_text(image.cubin)));
    return image;
}

Module::Module(const ModuleImage& image) : image_(image) {
    PT_CUDA_CHECK(cudaLibraryLoadData(&library_, image_.cubin.data(), nullptr, nullptr, 0, nullptr, nullptr, 0));
}

Module::~Module() { (void)cudaLibraryUnload(library_); }

cudaKernel_t Module::kernel(const char* name) const {
    cudaKernel_t kernel = nullptr;
    if (const cudaError_t error = cudaLibraryGetKernel(&kernel, library_, name); error != cudaSuccess) {
        (void)cudaGetLastError();
        throw Error(fmt::format("no kernel {}: {}", name, cudaGetErrorString(error)));
    }
    return kernel;
}

void* Module::global(const char* name) const {
    void* address = nullptr;
    std::size_t bytes = 0;
    PT_CUDA_CHECK(cudaLibraryGetGlobal(&address, &bytes, library_, name));
    return address;
}

KernelFacts Module::facts(const char* name) const {
    cudaFuncAttributes attributes{};
    PT_CUDA_CHECK(cudaFuncGetAttributes(&attributes, static_cast<const void*>(kernel(name))));
    return {attributes.numRegs, attributes.localSizeBytes, attributes.sharedSizeBytes, attributes.maxThreadsPerBlock};
}

int Module::blocks_per_multiprocessor(const char* name, unsigned threads) const {
    int blocks = 0;
    PT_CUDA_CHECK(cudaOccupancyMaxActiveBlocksPerMultiprocessor(&blocks, static_cast<const void*>(kernel(name)),
                                                                static_cast<int>(threads), 0));
    return blocks;
}

void Module::launch_pointers(const char* name, unsigned blocks, unsigned threads, cudaStream_t stream,
                             const void** parameters) const {
    const cudaError_t error = cudaLaunchKernel(static_cast<const void*>(kernel(name)), dim3(blocks), dim3(threads),
                                               const_cast<void**>(parameters), 0, stream);
    if (error != cudaSuccess) {
        (void)cudaGetLastError();
        throw Error(fmt::format("kernel {}, {} blocks of {}: {}", name, blocks, threads, cudaGetErrorString(error)));
    }
}

}  // namespace pt::cuda
