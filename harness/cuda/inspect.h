// What a variant's kernels are made of: registers, spills, occupancy, machine code by pipe, bytes a path. From
// compilation alone, for any architecture.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "harness/scene/scene.h"
#include "variants/descriptor.h"

namespace pt::cuda {

// Blocks of a kernel that a multiprocessor holds at once, and what stops it from holding more.
struct Occupancy {
    int blocks = 0;
    int warps = 0, most_warps = 0;
    std::string limit;  // "registers", "shared memory", "warps" or "blocks"
};

// The occupancy of a kernel by the limits of the compute capability ("sm_90") in the CUDA C++ Programming Guide's
// table. Throws InputError for an architecture that the table here lacks.
Occupancy occupancy(const std::string& architecture, int registers, int shared_bytes, int threads_per_block);
// The architectures that occupancy() knows, as "sm_75, sm_80, ...".
std::string known_architectures();

// Compiles for the scene all that NVRTC compiles of the variant, its integrator and the compaction and sorting of its
// queue, and reports on each kernel; what nvcc compiled with ptbench (Thrust and CUB) is named under "library_calls".
// Throws InputError for a variant that does not apply or an unknown architecture, DoesNotCompile with NVRTC's words on
// each program that it refused, MachineError where NVRTC is missing.
nlohmann::ordered_json inspect(const Scene& scene, const Variant& variant, const std::string& architecture);

}  // namespace pt::cuda
