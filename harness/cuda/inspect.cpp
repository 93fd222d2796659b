#include "harness/cuda/inspect.h"

#include <algorithm>

#include <fmt/format.h>

#include "harness/cuda/backend.h"
#include "harness/cuda/kernel_request.h"
#include "harness/cuda/sass.h"
#include "harness/failure.h"
#include "harness/render/renderer.h"
#include "harness/variant_json.h"
#include "variants/cuda/runtime/compiler_report.h"
#include "variants/cuda/stages.h"
#include "variants/variant_name.h"

namespace pt::cuda {

using Json = nlohmann::ordered_json;

namespace {

struct Limits {
    const char* architecture;
    int warps, blocks, shared_kib;  // limits of a multiprocessor: warps, thread blocks, KiB of shared memory
    int reserved_shared;            // bytes of shared memory that the system reserves per thread block
    int shared_unit;                // granularity of shared memory per thread block, bytes
};

// CUDA C++ Programming Guide 13.0, "Technical Specifications per Compute Capability"; all GPUs have 65536 registers.
constexpr Limits all_limits[] = {
    {"sm_75", 32, 16, 64, 0, 256},      {"sm_80", 64, 32, 164, 1024, 128},  {"sm_86", 48, 16, 100, 1024, 128},
    {"sm_87", 48, 16, 164, 1024, 128},  {"sm_89", 48, 24, 100, 1024, 128},  {"sm_90", 64, 32, 228, 1024, 128},
    {"sm_100", 64, 32, 228, 1024, 128}, {"sm_103", 64, 32, 228, 1024, 128}, {"sm_120", 48, 24, 100, 1024, 128},
};
constexpr int registers_per_multiprocessor = 65536;
constexpr int register_unit = 256;  // unit in which registers are allocated to a warp

const Limits& limits_of(const std::string& architecture) {
    for (const Limits& limits : all_limits) {
        if (architecture == limits.architecture) {
            return limits;
        }
    }
    throw InputError("command line", "--arch", architecture, known_architectures());
}

int rounded_up(int value, int unit) { return (value + unit - 1) / unit * unit; }

Json pipes_json(const PipeCounts& counts) {
    Json json = Json::object();
    std::size_t total = 0;
    for (const auto& [pipe, count] : counts) {
        total += count;
    }
    json["total"] = total;
    for (const auto& [pipe, count] : counts) {
        json[pipe] = count;
    }
    return json;
}

// A program that NVRTC compiles for a variant.
struct Program {
    std::string of;  // "compaction=atomic_append"
    ModuleRequest request;
    std::uint32_t threads;  // number of threads per thread block
    bool is_launched = true;
};

std::string of_choice(const Descriptor& choice) { return fmt::format("{}={}", choice.axis, choice.name); }

// Whether the integrator's kernel also does the work of the compaction, whose kernels are loaded but not launched.
bool is_done_by_integrator(const Choice& stage, const VariantTraits& traits) {
    return stage.descriptor.axis == axes::compaction && traits.integrator.appends_in_kernel &&
           traits.compaction.can_append_in_kernel();
}

std::vector<Program> programs_of(const Scene& scene, const Variant& variant, const std::string& architecture) {
    std::vector<Program> programs{{"integrator=" + variant[axes::integrator],
                                   module_request(scene, variant, architecture),
                                   tunable(variant, "block", Backend::cuda)}};
    for (const Choice* const stage : stages_of(variant)) {
        if (!stage->hook.cuda.kernels.empty()) {
            programs.push_back({of_choice(stage->descriptor), stage_request(variant, *stage, architecture), stage_block,
                                !is_done_by_integrator(*stage, traits_of(variant, Backend::cuda))});
        }
    }
    return programs;
}

// The stages of a variant that are library calls, compiled by nvcc with ptbench, possibly for other GPUs than this one.
Json library_calls(const Variant& variant) {
    Json calls = Json::array();
    for (const Choice* const stage : stages_of(variant)) {
        if (stage->hook.cuda.kernels.empty()) {
            calls.push_back(of_choice(stage->descriptor));
        }
    }
    return calls;
}

CompilerReport report_of(const Program& program) {
    try {
        return compiler_report(program.request);
    } catch (const CompileError&) {
        throw;
    } catch (const std::runtime_error& error) {
        throw MachineError(fmt::format("cuda: {}", error.what()));
    }
}

Json kernel_json(const KernelReport& reported, const Program& program) {
    std::uint32_t most_threads = program.threads;
    for (const KernelSignature& kernel : program.request.kernels) {
        most_threads = kernel.name == reported.name ? std::min(most_threads, kernel.most_threads) : most_threads;
    }
    const int threads = static_cast<int>(most_threads);
    const Occupancy held = occupancy(program.request.architecture, reported.registers, reported.shared_bytes, threads);
    Json entry{{"name", reported.name},
               {"of", program.of},
               {"registers", reported.registers},
               {"stack_bytes", reported.stack_bytes},
               {"spill_store_bytes", reported.spill_store_bytes},
               {"spill_load_bytes", reported.spill_load_bytes},
               {"shared_bytes", reported.shared_bytes},
               {"threads_per_block", threads},
               {"blocks_per_multiprocessor", held.blocks},
               {"warps_per_multiprocessor", held.warps},
               {"occupancy", static_cast<double>(held.warps) / held.most_warps},
               {"occupancy_limit", held.limit}};
    if (!program.is_launched) {
        entry["launched"] = false;
    }
    return entry;
}

void add_kernels(const Program& program, const CompilerReport& report, const std::string& nvdisasm, Json& kernels) {
    std::vector<KernelCode> code;
    if (!nvdisasm.empty()) {
        code = count_instructions(disassemble(nvdisasm, report.cubin));
    }
    for (const KernelReport& reported : report.kernels) {
        kernels.push_back(kernel_json(reported, program));
        for (const KernelCode& counted : code) {
            if (counted.name == reported.name) {
                kernels.back()["instructions"] = pipes_json(counted.all);
                kernels.back()["instructions_in_loop"] = pipes_json(counted.loop);
            }
        }
    }
}

}  // namespace

std::string known_architectures() {
    std::string names;
    for (const Limits& limits : all_limits) {
        names += (names.empty() ? "" : ", ") + std::string(limits.architecture);
    }
    return names;
}

Occupancy occupancy(const std::string& architecture, int registers, int shared_bytes, int threads_per_block) {
    const Limits& limits = limits_of(architecture);
    const int warps_per_block = (threads_per_block + 31) / 32;
    const int registers_per_warp = rounded_up(std::max(1, registers) * 32, register_unit);
    // Registers are divided among the four partitions of a multiprocessor, and each warp resides in one partition.
    const int by_registers = registers_per_multiprocessor / 4 / registers_per_warp * 4 / warps_per_block;
    const int shared_per_block = rounded_up(shared_bytes + limits.reserved_shared, limits.shared_unit);
    const int by_shared = shared_per_block == 0 ? limits.blocks : limits.shared_kib * 1024 / shared_per_block;
    const std::pair<int, const char*> bounds[] = {{limits.warps / warps_per_block, "warps"},
                                                  {limits.blocks, "blocks"},
                                                  {by_registers, "registers"},
                                                  {by_shared, "shared memory"}};
    const auto least = *std::min_element(std::begin(bounds), std::end(bounds),
                                         [](const auto& a, const auto& b) { return a.first < b.first; });
    return {least.first, least.first * warps_per_block, limits.warps, least.second};
}

Json inspect(const Scene& scene, const Variant& variant, const std::string& architecture) {
    (void)limits_of(architecture);
    if (const std::string reason = why_not_applicable(variant, features_of(scene), Backend::cuda); !reason.empty()) {
        throw InputError(fmt::format("n/a: {} on {}: {}", shown_name(variant, Backend::cuda), scene.name, reason));
    }
    const KernelChoice kernel = choose_kernel(scene, variant, Backend::cuda);
    const std::string nvdisasm = find_nvdisasm();
    double seconds = 0;
    std::size_t bytes = 0;
    std::vector<std::string> options;
    Json kernels = Json::array();
    std::string errors;
    for (const Program& program : programs_of(scene, variant, architecture)) {
        try {
            const CompilerReport report = report_of(program);
            add_kernels(program, report, nvdisasm, kernels);
            seconds += report.compile_seconds;
            bytes += report.cubin.size();
            options = options.empty() ? report.options : options;
        } catch (const CompileError& error) {
            errors += fmt::format("{}{}: {}", errors.empty() ? "" : "\n", program.of, error.what());
        }
    }
    if (!errors.empty()) {
        throw DoesNotCompile(errors);
    }
    return {{"scene", scene.name},
            {"variant", shown_name(variant, Backend::cuda)},
            {"variant_id", variant_id(variant, Backend::cuda)},
            {"axes", axes_json(variant)},
            {"architecture", architecture},
            {"features", feature_names(kernel.compiled)},
            {"left_out", feature_names(all_features & ~kernel.compiled)},
            {"compile_seconds", seconds},
            {"options", options},
            {"code_bytes", bytes},
            {"disassembler", nvdisasm.empty() ? "not found: no instruction counts (set PTBENCH_NVDISASM)" : nvdisasm},
            {"kernels", kernels},
            {"library_calls", library_calls(variant)}};
}

}  // namespace pt::cuda
