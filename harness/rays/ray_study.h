// Rates of ray batches: accelerators, builders and kernels side by side on the same rays, every hit of one held to that
// of the others and a subset to brute force.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "harness/rays/ray_batch.h"
#include "harness/rays/ray_meshes.h"
#include "variants/descriptor.h"

namespace pt::rays {

struct RayStudy {
    Backend backend = Backend::cpu;
    std::vector<std::string> accelerators, builders, classes;
    std::uint32_t log2_rays = 20;
    int repetitions = 9;
    std::uint32_t checked = 1024;    // rays of a set that are held to brute force
    std::vector<RaySet> given = {};  // instead of rays that are made; of these, those of `classes`
};

struct MeshResult {
    nlohmann::ordered_json json;
    std::vector<RaySet> sets;
    std::vector<std::uint64_t> hits;  // of each set, how many rays hit
    bool agrees = true;               // all hits among each other, and with brute force
};

MeshResult measure(const RayMesh& mesh, const RayStudy& study);

// The rates of what `measure` said, a line a batch.
std::string table_of(const nlohmann::ordered_json& mesh);

}  // namespace pt::rays
