// What a variant's kernels did while they ran, from the GPU's own counters by way of NVIDIA's Nsight Compute (ncu), and
// the bound that each runs at: the pipe, or the memory, that is nearest to what this GPU was measured to do at most.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "harness/cuda/ceilings.h"

namespace pt::cuda {

// Counters of one kernel, over all its launches.
struct KernelCounters {
    std::string name;
    std::uint64_t launches = 0;
    double seconds = 0;
    double instructions = 0;                             // a warp each
    double thread_instructions = 0;                      // instructions times the lanes that were active
    double fma = 0, alu = 0, xu = 0, lsu = 0, fp64 = 0;  // of the instructions, by pipe
    double memory_bytes = 0;                             // to and from device memory
    // Averages from 0 to 1, weighted by time. For a cache: the busiest part of the unit, of its peak as ncu knows it.
    double occupancy = 0;   // achieved, of the most warps
    double l1 = 0, l2 = 0;  // throughput
    double l1_hit_rate = 0, l2_hit_rate = 0;
    double memory_stalls = 0;  // of the time of warps that are there: waiting for what they loaded
};

// One launch of a batch of rays, as `ptbench rays --counted` makes it.
struct CountedBatch {
    std::string function;  // of the kernel, without its templates' arguments
    double rays = 0;
};

// The path of ncu, from $PTBENCH_NCU, the PATH or the toolkit; empty: it is in none of them.
std::string find_ncu();

// Renders `spp` samples a pixel once more, under ncu, in a process of its own: `arguments` are those of `ptbench
// render`. Throws MachineError if ncu fails (it needs the right to read counters).
std::vector<KernelCounters> count_under_ncu(const std::string& ncu, const std::vector<std::string>& arguments,
                                            const std::vector<std::string>& kernels);

// Runs `ptbench rays --counted` with these arguments under ncu: every launch between calls of switch_counting, in
// order.
std::vector<KernelCounters> count_launches_under_ncu(const std::string& ncu, const std::vector<std::string>& arguments);

// Reads `ncu --csv --page raw`: an entry a launch, in their order.
std::vector<KernelCounters> parse_ncu_launches(const std::string& csv);
// Reads `ncu --csv --page raw` and sums the launches of each kernel; one entry for each kernel, by name.
std::vector<KernelCounters> parse_ncu_csv(const std::string& csv);

nlohmann::ordered_json ceilings_json(const Ceilings& ceilings);
// The counters in figures that compare: a ray, and as fractions of the ceilings. `rays`: that the kernels traced.
nlohmann::ordered_json counters_json(const KernelCounters& counters, const Ceilings& ceilings, double rays);

// The figures of each batch, as counters_json gives them. Throws MachineError unless the launches are those of the
// batches, one each.
std::vector<nlohmann::ordered_json> batch_counters_json(const std::vector<KernelCounters>& launches,
                                                        const std::vector<CountedBatch>& batches,
                                                        const Ceilings& ceilings);

}  // namespace pt::cuda
