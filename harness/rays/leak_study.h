// Whether a closed mesh lets rays through between its triangles: rays from within that no triangle stops, by class,
// through every accelerator and kernel.
#pragma once

#include "harness/rays/leak_rays.h"
#include "harness/rays/ray_study.h"

namespace pt::rays {

struct LeakStudy {
    RayStudy trees;  // backend, accelerators and builders
    std::uint32_t log2_rays = 20;
    std::uint64_t first_ray = 0, seed = 1;
};

// A mesh without the box that mesh_for_rays puts round it. Throws InputError for one that is not closed.
RayMesh closed_mesh_for_rays(const std::string& argument);

// Cubes within a closed mesh, `count` or fewer where few places are well inside. Throws InputError where there is none.
LeakSource leak_source(const RayMesh& mesh, std::uint32_t count, std::uint64_t seed);

struct LeakResult {
    nlohmann::ordered_json json;
    std::uint64_t leaks = 0;
};

LeakResult measure_leaks(const RayMesh& mesh, const LeakStudy& study);

// What `measure_leaks` said, a line a kernel, and one for each of the first rays that leaked.
std::string leak_table_of(const nlohmann::ordered_json& mesh);

}  // namespace pt::rays
