// Rates of ray batches: accelerators, builders and kernels side by side on the same rays, every hit of one held to that
// of the others and a subset to brute force.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "harness/rays/ray_batch.h"
#include "harness/rays/ray_meshes.h"
#include "harness/scene/mesh_geometry.h"
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

// A mesh's tree, as batches are traced through it.
struct Tree {
    std::string accelerator, builder;  // builder empty: the accelerator needs no tree
    MeshGeometry geometry;
    MeshView view;
    MeetMesh<float> meet;
};
std::shared_ptr<const SceneMesh> as_scene_mesh(const RayMesh& mesh, const std::string& hash);
Tree make_tree(const std::shared_ptr<const SceneMesh>& mesh, const std::string& accelerator, const std::string& builder,
               Backend backend);
std::unique_ptr<BatchTracer> make_tracer(const Tree& tree, Backend backend);
// The trees of a study, one for each accelerator and builder; an accelerator without a tree has no builder.
std::vector<std::pair<std::string, std::string>> trees_of(const RayStudy& study);

// The study's rays: those that it was given, or made by tracing.
std::vector<RaySet> ray_sets_of(const RayMesh& mesh, BatchTracer& tracer, const RayStudy& study);

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
