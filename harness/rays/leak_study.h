// Tests whether rays from inside a closed mesh leak out between its triangles, with every accelerator and kernel, by
// class of ray.
#pragma once

#include "harness/rays/leak_rays.h"
#include "harness/rays/ray_study.h"

namespace pt::rays {

struct LeakStudy {
    RayStudy trees;  // the backend, accelerators and builders to test
    std::uint32_t log2_rays = 20;
    std::uint64_t first_ray = 0, seed = 1;
};

// Loads a closed mesh, without the box that mesh_for_rays puts around it. Throws InputError if the mesh is not closed.
RayMesh closed_mesh_for_rays(const std::string& argument);

// Finds random cubes well inside a closed mesh, `count` or fewer. Throws InputError if there are none.
LeakSource leak_source(const RayMesh& mesh, std::uint32_t count, std::uint64_t seed);

struct LeakResult {
    nlohmann::ordered_json json;
    std::uint64_t leaks = 0;
};

LeakResult measure_leaks(const RayMesh& mesh, const LeakStudy& study);

// The result of `measure_leaks` as a table, one line per kernel and one for each of the first rays that leaked.
std::string leak_table_of(const nlohmann::ordered_json& mesh);

}  // namespace pt::rays
