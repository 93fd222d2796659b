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
    double occupancy = 0;                                // achieved, of the most warps; weighted by time
};

// Where ncu is: $PTBENCH_NCU, the PATH, the toolkit; empty: nowhere.
std::string find_ncu();

// Renders `spp` samples a pixel once more, under ncu, in a process of its own: `arguments` are those of `ptbench
// render`. Throws MachineError if ncu fails (it needs the right to read counters).
std::vector<KernelCounters> count_under_ncu(const std::string& ncu, const std::vector<std::string>& arguments,
                                            const std::vector<std::string>& kernels);

// Reads `ncu --csv --page raw`.
std::vector<KernelCounters> parse_ncu_csv(const std::string& csv);

// The counters in figures that compare: a ray, and as fractions of the ceilings. `rays`: that the kernels traced.
nlohmann::ordered_json counters_json(const KernelCounters& counters, const Ceilings& ceilings, double rays);

}  // namespace pt::cuda
