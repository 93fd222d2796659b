// Stands in for the CUDA backend in a build that found no CUDA toolkit.
#include <nlohmann/json.hpp>

#include "harness/cuda/backend.h"
#include "harness/failure.h"
#include "harness/machine/run_context.h"

namespace pt::cuda {

namespace {
constexpr const char* reason = "this ptbench was built without a CUDA toolkit";
}

std::string not_available() { return reason; }
RenderResult render(const Scene&, const RenderRequest&) { throw MachineError(reason); }
[[maybe_unused]] const bool is_told = set_cuda_render(&render);
std::size_t compile(const Scene&, const Variant&, const std::string&) { throw MachineError(reason); }
nlohmann::ordered_json inspect_kernels(const Scene&, const Variant&, const std::string&) { throw MachineError(reason); }
nlohmann::ordered_json kernel_counters(const std::vector<std::string>&, const std::vector<std::string>&, double) {
    throw MachineError(reason);
}
nlohmann::ordered_json ceilings() { throw MachineError(reason); }
nlohmann::ordered_json gpu_rates() { throw MachineError(reason); }
void require_counters() { throw MachineError(reason); }
nlohmann::ordered_json batch_counters(const std::vector<std::string>&,
                                      const std::vector<std::pair<std::string, double>>&) {
    throw MachineError(reason);
}
void switch_counting(bool) {}
std::string why_not_an_architecture(const std::string&) { return "this build has no CUDA"; }
std::string architectures() { return "none: this build has no CUDA"; }
std::string kernel_cache() { return ""; }
struct SharedHeaders::Implementation {};
SharedHeaders::SharedHeaders() = default;
SharedHeaders::~SharedHeaders() = default;
void collect_programs(const Scene&, const Variant&, const std::string&, bool, ProgramsToCompile&) {}
std::string machine_name() { throw MachineError(reason); }
bool runs_processes_at_once() { return false; }
std::optional<GpuContext> context() { return std::nullopt; }
double measure_clock_mhz() { return 0; }

}  // namespace pt::cuda
