#include "harness/cuda/backend.h"

#include <bit>
#include <cctype>

#include <cuda_profiler_api.h>
#include <fmt/format.h>

#include "cccl_version.h"
#include "harness/cuda/cell.h"
#include "harness/cuda/gpu_rates.h"
#include "harness/cuda/inspect.h"
#include "harness/cuda/kernel_request.h"
#include "harness/cuda/profile.h"
#include "harness/cuda/several_devices.h"
#include "harness/failure.h"
#include "harness/machine/run_context.h"
#include "harness/render/renderer.h"
#include "variants/cuda/runtime/check.h"
#include "variants/cuda/runtime/device.h"
#include "variants/cuda/runtime/nccl.h"
#include "variants/cuda/runtime/nvrtc.h"
#include "variants/variant_name.h"

namespace pt::cuda {

namespace {

template <class Real>
void render_in(const Scene& scene, const RenderRequest& request, const RenderSettings& settings,
               const KernelChoice& kernel, RenderResult& result) {
    if (traits_of(request.variant, Backend::cuda).devices.count > 1) {
        render_on_devices<Real>(scene, request, settings, kernel, result);
        return;
    }
    RenderCell<Real> cell(scene, request, settings, kernel, result.film.view());
    cell.run(result);
    cell.collect(result);
}

const Ceilings& ceilings_here() {
    static const Ceilings ceilings = measure_ceilings();
    return ceilings;
}

}  // namespace

std::string not_available() {
    static const std::string reason = [] {
        const std::string missing = device_missing();
        return missing.empty() ? nvrtc_missing() : missing;
    }();
    return reason;
}

[[maybe_unused]] const bool is_told = set_cuda_render(&render);

RenderResult render(const Scene& scene, const RenderRequest& request) {
    if (!not_available().empty()) {
        throw MachineError("cuda: not available (" + not_available() + ")");
    }
    const KernelChoice kernel = choose_kernel(scene, request.variant, Backend::cuda);
    const RenderSettings settings = settings_for(request, kernel);
    const std::uint64_t film_samples = request.film_samples != 0 ? request.film_samples : request.samples;
    RenderResult result{.film = Film(settings.width, settings.height, radiance_bound(scene, settings), film_samples),
                        .work = {},
                        .stages = {},
                        .needed = kernel.needed,
                        .compiled = kernel.compiled};
    try {
        if (traits_of(request.variant, Backend::cuda).precision.is_double()) {
            render_in<double>(scene, request, settings, kernel, result);
        } else {
            render_in<float>(scene, request, settings, kernel, result);
        }
    } catch (const Error& error) {
        throw MachineError(fmt::format("{} of {} at {}x{}, {} spp on {}: {}",
                                       shown_name(request.variant, Backend::cuda), scene.name, settings.width,
                                       settings.height, request.samples, device().name, error.what()));
    }
    return result;
}

std::size_t compile(const Scene& scene, const Variant& variant, const std::string& architecture) {
    return compile_module(module_request(scene, variant, architecture)).cubin.size();
}

nlohmann::ordered_json inspect_kernels(const Scene& scene, const Variant& variant, const std::string& architecture) {
    if (architecture.empty() && !device_missing().empty()) {
        throw MachineError("cuda: " + device_missing() + ": name an architecture with --arch (" +
                           known_architectures() + ")");
    }
    return inspect(scene, variant, architecture.empty() ? device().architecture() : architecture);
}

nlohmann::ordered_json ceilings() { return ceilings_json(ceilings_here()); }

nlohmann::ordered_json gpu_rates() { return measure_gpu_rates(); }

void require_counters() {
    if (!not_available().empty() || find_ncu().empty()) {
        throw MachineError("counters: not available (" +
                           (find_ncu().empty() ? "ncu is not found; set PTBENCH_NCU" : not_available()) + ")");
    }
}

nlohmann::ordered_json kernel_counters(const std::vector<std::string>& arguments,
                                       const std::vector<std::string>& kernels, double rays) {
    require_counters();
    const Ceilings& ceilings = ceilings_here();
    nlohmann::ordered_json json{{"ceilings", ceilings_json(ceilings)}, {"kernels", nlohmann::ordered_json::object()}};
    for (const KernelCounters& counters : count_under_ncu(find_ncu(), arguments, kernels)) {
        json["kernels"][counters.name] = counters_json(counters, ceilings, rays);
    }
    return json;
}

nlohmann::ordered_json batch_counters(const std::vector<std::string>& arguments,
                                      const std::vector<std::pair<std::string, double>>& batches) {
    require_counters();
    std::vector<CountedBatch> wanted;
    for (const auto& [function, rays] : batches) {
        wanted.push_back({function, rays});
    }
    const Ceilings& ceilings = ceilings_here();
    return {{"ceilings", ceilings_json(ceilings)},
            {"launches", batch_counters_json(count_launches_under_ncu(find_ncu(), arguments), wanted, ceilings)}};
}

void switch_counting(bool on) { PT_CUDA_CHECK(on ? cudaProfilerStart() : cudaProfilerStop()); }

std::string why_not_an_architecture(const std::string& name) {
    const std::string known = known_architectures();
    const bool is_known = !name.empty() && (", " + known + ",").find(", " + name + ",") != std::string::npos;
    return is_known ? "" : fmt::format("\"{}\" is no architecture (allowed: {})", name, known);
}

std::string architectures() { return known_architectures(); }

std::string kernel_cache() { return kernel_cache_folder(); }

struct SharedHeaders::Implementation {
    PrecompiledHeaders headers;
};
SharedHeaders::SharedHeaders() : implementation_(std::make_unique<Implementation>()) {}
SharedHeaders::~SharedHeaders() = default;

void collect_programs(const Scene& scene, const Variant& variant, const std::string& architecture, bool alone,
                      ProgramsToCompile& programs) {
    if (architecture.empty() && !not_available().empty()) {
        return;
    }
    const std::string target = architecture.empty() ? device().architecture() : architecture;
    for (const Variant& needed :
         alone ? std::vector<Variant>{variant} : rendered_to_check(scene, variant, Backend::cuda)) {
        for (const ModuleRequest& request : module_requests(scene, needed, target)) {
            if (!is_cached(request)) {
                programs.try_emplace(request.name + " " + module_key(request),
                                     ProgramToCompile{[request] { (void)build_module(request); },
                                                      std::popcount(request.config.features)});
            }
        }
    }
}

std::string machine_name() {
    std::string name;
    for (const char c : device().name) {
        const auto byte = static_cast<unsigned char>(c);
        name += std::isalnum(byte) != 0 ? static_cast<char>(std::tolower(byte)) : '-';
    }
    return name;
}

bool runs_processes_at_once() { return not_available().empty() && device().mps; }

std::optional<GpuContext> context() {
    if (!not_available().empty()) {
        return std::nullopt;
    }
    const Device& d = device();
    GpuContext facts{.device = d.name,
                     .compute_capability = fmt::format("{}.{}", d.major, d.minor),
                     .multiprocessors = std::to_string(d.multiprocessors),
                     .clock_mhz = std::to_string(d.clock_khz / 1000),
                     .memory_clock_mhz = std::to_string(d.memory_clock_khz / 1000),
                     .memory_bus_bits = std::to_string(d.memory_bus_bits),
                     .memory_mib = std::to_string(d.memory_bytes >> 20),
                     .l2_bytes = std::to_string(d.l2_bytes),
                     .ecc = d.ecc ? "true" : "false",
                     .mps = d.mps ? "true" : "false",
                     .driver = version_text(d.driver_version),
                     .runtime = version_text(d.runtime_version),
                     .nvrtc = nvrtc_version(),
                     .cccl = PTBENCH_CCCL_VERSION,
                     .kernel_source_hash = kernel_source_hash()};
    if (equal_devices() > 1) {
        facts.devices = std::to_string(equal_devices());
        facts.nccl = nccl_version().empty() ? "none" : nccl_version();
    }
    return facts;
}

}  // namespace pt::cuda
