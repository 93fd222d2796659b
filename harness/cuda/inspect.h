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

// By the limits of the compute capability ("sm_90") in the CUDA C++ Programming Guide's table. Throws InputError for
// an architecture that the table here lacks.
Occupancy occupancy(const std::string& architecture, int registers, int shared_bytes, int threads_per_block);
// "sm_75, sm_80, ...": those that occupancy knows.
std::string known_architectures();

// Compiles the variant's integrator for the scene and reports on it. Throws InputError for a variant that does not
// apply or an unknown architecture, MachineError where NVRTC is missing.
nlohmann::ordered_json inspect(const Scene& scene, const Variant& variant, const std::string& architecture);

}  // namespace pt::cuda
