// The interface of the CUDA backend. In a build without a CUDA toolkit the functions exist too (without_cuda.cpp), but
// report that the backend is not available.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "harness/render/renderer.h"

namespace pt {
struct GpuContext;
}

namespace pt::cuda {

// Says why CUDA cannot be used (no toolkit at build time, no driver, no device, no NVRTC); empty if it can.
std::string not_available();

// Renders on the first device, or on as many devices as the variant says. Throws MachineError if the backend is not
// available, if memory runs out (with the size asked for) or if a CUDA call fails.
RenderResult render(const Scene& scene, const RenderRequest& request);

// Compiles the kernels of a variant for an architecture ("sm_90") without a device, a driver or the kernel cache, and
// returns the code size in bytes. If compilation fails, the exception contains the compiler's log.
std::size_t compile(const Scene& scene, const Variant& variant, const std::string& architecture);

// Thrown when NVRTC rejects a kernel: an error in the sources, not of the machine.
class DoesNotCompile : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

// Inspects a variant's compiled kernels (harness/cuda/inspect.h) for an architecture ("sm_90") or, if that is empty,
// for this machine's GPU. Throws MachineError if there is no GPU to ask.
nlohmann::ordered_json inspect_kernels(const Scene& scene, const Variant& variant, const std::string& architecture);

// Hardware counters of a variant's kernels in a render (harness/cuda/profile.h). `arguments` are those of `ptbench
// render`, `rays` is the number of rays of such a render. Returns {"ceilings": .., "kernels": {NAME: ..}}. Throws
// MachineError without a device or ncu.
nlohmann::ordered_json kernel_counters(const std::vector<std::string>& arguments,
                                       const std::vector<std::string>& kernels, double rays);

// Peak rates of the first GPU (harness/cuda/ceilings.h), by the keys of `ceilings` in ptbench-inspect.schema.json.
nlohmann::ordered_json ceilings();
// What bounds kernels on the first GPU beside its arithmetic (harness/cuda/gpu_rates.h).
nlohmann::ordered_json gpu_rates();

// Throws MachineError if hardware counters are not available: no device or no ncu.
void require_counters();
// Hardware counters of batches of rays, for the arguments of `ptbench rays`. A batch is the name of its kernel function
// and its number of rays; batches are in the order of the launches between calls of switch_counting. Returns
// {"ceilings": .., "launches": [..]}.
nlohmann::ordered_json batch_counters(const std::vector<std::string>& arguments,
                                      const std::vector<std::pair<std::string, double>>& batches);
// Switches under ncu whether the following launches are counted.
void switch_counting(bool on);

// Says what is wrong with the name of an architecture ("sm_90"); empty if it is valid.
std::string why_not_an_architecture(const std::string& name);
// All architectures that `inspect --arch` and `--compile --arch` take, as "sm_75, sm_80, ..".
std::string architectures();
// The folder of the kernel cache; empty in a build without CUDA.
std::string kernel_cache();

// While a `SharedHeaders` lives, programs that this process compiles share headers that are precompiled once.
class SharedHeaders {
public:
    SharedHeaders();
    ~SharedHeaders();
    SharedHeaders(const SharedHeaders&) = delete;
    SharedHeaders& operator=(const SharedHeaders&) = delete;

private:
    struct Implementation;
    std::unique_ptr<Implementation> implementation_;
};

// A program to compile into the kernel cache on disk, and its number of features: the more, the longer it takes.
struct ProgramToCompile {
    std::function<void()> compile;
    int features = 0;
};
using ProgramsToCompile = std::map<std::string, ProgramToCompile>;

// Adds the programs that a variant needs for a scene and that are not in the kernel cache on disk, for an architecture
// ("sm_90") without a device or driver, or for this machine's GPU if it is empty (nothing without one). `alone`: only
// the variant's own programs, without those of variants that it is verified against.
void collect_programs(const Scene& scene, const Variant& variant, const std::string& architecture, bool alone,
                      ProgramsToCompile& programs);

// The machine's name for folders, e.g. "nvidia-h200". Precondition: not_available() is empty.
std::string machine_name();
// Whether processes share the device concurrently (NVIDIA's MPS) rather than in time slices; false without a backend.
bool runs_processes_at_once();
// The facts about the GPU for the context of a result file; nothing if the backend is not available.
std::optional<GpuContext> context();

// The clock of the GPU's multiprocessors: cycles of a chain of dependent additions against a nanosecond timer.
double measure_clock_mhz();

}  // namespace pt::cuda
