// The CUDA backend as the harness sees it. A build without a CUDA toolkit has these functions too (without_cuda.cpp):
// it says that the backend is not available.
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
struct GpuContext;  // harness/machine/run_context.h
}

namespace pt::cuda {

// Why CUDA cannot be used here (no toolkit at build time, no driver, no device, no NVRTC); empty: it can.
std::string not_available();

// Renders on the first device, or on as many as the variant says. Throws MachineError if the backend is not available,
// if memory runs out (with the size asked for) or if a call fails.
RenderResult render(const Scene& scene, const RenderRequest& request);

// Compiles the kernels of a variant for an architecture ("sm_90"), without a device, a driver or the cache; the
// compiler's log is in the exception if it fails. Returns the size of the code.
std::size_t compile(const Scene& scene, const Variant& variant, const std::string& architecture);

// A kernel that NVRTC refuses: the sources' fault, not the machine's.
class DoesNotCompile : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

// What the variant's kernels are made of (harness/cuda/inspect.h), for an architecture; empty: the device's. Throws
// MachineError where it is empty and there is no device.
nlohmann::ordered_json inspect_kernels(const Scene& scene, const Variant& variant, const std::string& architecture);

// What those kernels did in a render, from the GPU's counters (harness/cuda/profile.h): `arguments` are those of
// `ptbench render`, `rays` what such a render traces. {"ceilings": .., "kernels": {NAME: ..}}. Throws MachineError
// where there is no device or no ncu.
nlohmann::ordered_json kernel_counters(const std::vector<std::string>& arguments,
                                       const std::vector<std::string>& kernels, double rays);

// Throws MachineError where counters cannot be had: no device, no ncu.
void require_counters();
// Hardware counters of ray batches, whose arguments are those of `ptbench rays`: a batch is the kernel's function and
// the number of its rays, in the order of the launches between calls of switch_counting. Returns {"ceilings": ..,
// "launches": [..]}.
nlohmann::ordered_json batch_counters(const std::vector<std::string>& arguments,
                                      const std::vector<std::pair<std::string, double>>& batches);
// Switches, under ncu, whether what is launched from here on is counted.
void switch_counting(bool on);

// What is wrong with the name of an architecture ("sm_90"); empty: nothing.
std::string why_not_an_architecture(const std::string& name);
// The architectures that can be named, as "sm_75, sm_80, ..".
std::string architectures();
// The folder of compiled kernels; empty in a build without CUDA.
std::string kernel_cache();

// While it lives, the programs that this process compiles share headers that are translated once.
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

// A program to compile into the cache on disk, and how many features it has: the more, the longer it takes.
struct ProgramToCompile {
    std::function<void()> compile;
    int features = 0;
};
using ProgramsToCompile = std::map<std::string, ProgramToCompile>;

// Adds the programs that a variant of a scene needs and that are not in the cache on disk. For an architecture
// ("sm_90"), without a device or a driver; empty: for the device, and nothing is added if the backend is not available.
// `alone`: the variant's own, without those of the variants that its claim is held to.
void collect_programs(const Scene& scene, const Variant& variant, const std::string& architecture, bool alone,
                      ProgramsToCompile& programs);

// A name for folders, e.g. "nvidia-h200". Precondition: not_available() is empty.
std::string machine_name();
// Whether processes run on the device at once (NVIDIA's MPS) rather than by turns; false if not available.
bool runs_processes_at_once();
// What the context of a result file says of the GPU; nothing if it is not available.
std::optional<GpuContext> context();

// The multiprocessors' clock, measured on the device: a chain of dependent additions against its nanosecond timer.
double measure_clock_mhz();

}  // namespace pt::cuda
