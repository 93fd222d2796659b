#include "harness/cuda/inspect.h"

#include <algorithm>

#include <fmt/format.h>

#include "harness/cuda/kernel_request.h"
#include "harness/cuda/sass.h"
#include "harness/error.h"
#include "harness/render/renderer.h"
#include "harness/variant_json.h"
#include "variants/cuda/compiler_report.h"
#include "variants/variant_name.h"

namespace pt::cuda {

using Json = nlohmann::ordered_json;

namespace {

struct Limits {
    const char* architecture;
    int warps, blocks, shared_kib;  // a multiprocessor
    int reserved_shared;            // bytes a block that the system takes
    int shared_unit;                // bytes; shared memory is given to blocks in steps of this
};

// CUDA C++ Programming Guide 13.0, "Technical Specifications per Compute Capability". 65536 registers everywhere.
constexpr Limits all_limits[] = {
    {"sm_75", 32, 16, 64, 0, 256},      {"sm_80", 64, 32, 164, 1024, 128},  {"sm_86", 48, 16, 100, 1024, 128},
    {"sm_87", 48, 16, 164, 1024, 128},  {"sm_89", 48, 24, 100, 1024, 128},  {"sm_90", 64, 32, 228, 1024, 128},
    {"sm_100", 64, 32, 228, 1024, 128}, {"sm_103", 64, 32, 228, 1024, 128}, {"sm_120", 48, 24, 100, 1024, 128},
};
constexpr int registers_per_multiprocessor = 65536;
constexpr int register_unit = 256;  // registers are given to warps in steps of this

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
    // Registers belong to the four partitions of a multiprocessor, a warp to one of them.
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
    const CompilerReport report = [&] {
        try {
            return compiler_report(module_request(scene, variant, architecture));
        } catch (const CompileError&) {
            throw;
        } catch (const std::runtime_error& error) {
            throw MachineError(fmt::format("cuda: {}", error.what()));
        }
    }();
    const KernelChoice kernel = choose_kernel(scene, variant, Backend::cuda);
    const int threads = static_cast<int>(tunable(variant, "block", Backend::cuda));
    const std::string nvdisasm = find_nvdisasm();
    std::vector<KernelCode> code;
    if (!nvdisasm.empty()) {
        code = count_instructions(disassemble(nvdisasm, report.cubin));
    }
    Json json{
        {"scene", scene.name},
        {"variant", shown_name(variant, Backend::cuda)},
        {"variant_id", variant_id(variant, Backend::cuda)},
        {"axes", axes_json(variant)},
        {"architecture", architecture},
        {"features", feature_names(kernel.compiled)},
        {"left_out", feature_names(all_features & ~kernel.compiled)},
        {"compile_seconds", report.compile_seconds},
        {"options", report.options},
        {"code_bytes", report.cubin.size()},
        {"disassembler", nvdisasm.empty() ? "not found: no instruction counts (set PTBENCH_NVDISASM)" : nvdisasm}};
    for (const KernelReport& reported : report.kernels) {
        const Occupancy held = occupancy(architecture, reported.registers, reported.shared_bytes, threads);
        Json entry{{"name", reported.name},
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
        for (const KernelCode& counted : code) {
            if (counted.name == reported.name) {
                entry["instructions"] = pipes_json(counted.all);
                entry["instructions_in_loop"] = pipes_json(counted.loop);
            }
        }
        json["kernels"].push_back(entry);
    }
    return json;
}

}  // namespace pt::cuda
