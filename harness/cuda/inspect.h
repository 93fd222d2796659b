// Inspects a variant's compiled kernels: registers, spills, occupancy, instructions by pipe, bytes per path. Needs only
// compilation, so it works for any architecture without a device.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "harness/scene/scene.h"
#include "variants/descriptor.h"

namespace pt::cuda {

// The thread blocks of a kernel resident on a multiprocessor at once, and the resource that limits their number.
struct Occupancy {
    int blocks = 0;
    int warps = 0, most_warps = 0;
    std::string limit;  // "registers", "shared memory", "warps" or "blocks"
};

// The occupancy of a kernel by the limits that the CUDA C++ Programming Guide states for the compute capability
// ("sm_90"). Throws InputError for an architecture that is missing in `known_architectures`.
Occupancy occupancy(const std::string& architecture, int registers, int shared_bytes, int threads_per_block);
// The architectures known to occupancy(), as "sm_75, sm_80, ...".
std::string known_architectures();

// Compiles for the scene all programs of the variant that NVRTC compiles (its integrator, compaction and sorting), and
// reports on each kernel; stages that nvcc compiled with ptbench (Thrust and CUB) are listed under "library_calls".
// Throws InputError for a variant that does not apply or an unknown architecture, DoesNotCompile with NVRTC's log of
// each program that it rejected, MachineError if NVRTC is missing.
nlohmann::ordered_json inspect(const Scene& scene, const Variant& variant, const std::string& architecture);

}  // namespace pt::cuda
