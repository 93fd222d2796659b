// Measures a variant's kernels with the GPU's hardware counters through NVIDIA's Nsight Compute (ncu), and names the
// bound of each: the pipe or the memory whose rate is nearest to the measured ceiling of this GPU.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "harness/cuda/ceilings.h"

namespace pt::cuda {

// Hardware counters of one kernel, over all its launches.
struct KernelCounters {
    std::string name;
    std::uint64_t launches = 0;
    double seconds = 0;
    double instructions = 0;                             // warp instructions that the kernel executed
    double thread_instructions = 0;                      // executed warp instructions, each times its active lanes
    double fma = 0, alu = 0, xu = 0, lsu = 0, fp64 = 0;  // executed warp instructions by pipe
    double memory_bytes = 0;                             // bytes moved to and from device memory
    // Means over the kernel's launches, 0 to 1, weighted by time. A cache's throughput is that of its busiest part.
    double occupancy = 0;   // resident warps over the most that a multiprocessor holds
    double l1 = 0, l2 = 0;  // throughput of the L1 and L2 caches relative to the peak
    double l1_hit_rate = 0, l2_hit_rate = 0;
    double memory_stalls = 0;  // share of resident warps' time spent waiting for memory loads
};

// One launch of a batch of rays, as `ptbench rays --counted` makes it.
struct CountedBatch {
    std::string function;  // the kernel function's name without template arguments
    double rays = 0;
};

// The path of ncu, from $PTBENCH_NCU, the PATH or the CUDA toolkit; empty if none has it.
std::string find_ncu();

// Runs `ptbench render` with these arguments under ncu in a process of its own, and returns the counters of `kernels`.
// Throws MachineError if ncu fails (it needs permission to read counters).
std::vector<KernelCounters> count_under_ncu(const std::string& ncu, const std::vector<std::string>& arguments,
                                            const std::vector<std::string>& kernels);

// Runs `ptbench rays --counted` with these arguments under ncu, and returns the counters of every launch between calls
// of switch_counting, in order.
std::vector<KernelCounters> count_launches_under_ncu(const std::string& ncu, const std::vector<std::string>& arguments);

// Parses the output of `ncu --csv --page raw`: one entry for each launch, in order.
std::vector<KernelCounters> parse_ncu_launches(const std::string& csv);
// Parses the output of `ncu --csv --page raw` and sums the launches of each kernel: one entry for each kernel, by name.
std::vector<KernelCounters> parse_ncu_csv(const std::string& csv);

nlohmann::ordered_json ceilings_json(const Ceilings& ceilings);
// Converts hardware counters to comparable figures: per ray and as fractions of the ceilings. `rays`: number of rays
// traced.
nlohmann::ordered_json counters_json(const KernelCounters& counters, const Ceilings& ceilings, double rays);

// The figures of each batch, as made by counters_json. Throws MachineError unless each batch has exactly one launch.
std::vector<nlohmann::ordered_json> batch_counters_json(const std::vector<KernelCounters>& launches,
                                                        const std::vector<CountedBatch>& batches,
                                                        const Ceilings& ceilings);

}  // namespace pt::cuda
