// Measures the ray rates of accelerators, builders and kernels on the same rays. All hits are compared with each other,
// and those of a subset with brute force.
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
    std::uint32_t checked = 1024;    // number of rays of each set that are compared with brute force
    std::vector<RaySet> given = {};  // ray sets to use instead of generated ones
};

// An acceleration tree over a mesh, as ray batches traverse it.
struct Tree {
    std::string accelerator, builder;  // `builder`: empty for an accelerator without a tree
    MeshGeometry geometry;
    MeshView view;
    MeetMesh<float> meet;
};
std::shared_ptr<const SceneMesh> as_scene_mesh(const RayMesh& mesh, const std::string& hash);
Tree make_tree(const std::shared_ptr<const SceneMesh>& mesh, const std::string& accelerator, const std::string& builder,
               Backend backend);
std::unique_ptr<BatchTracer> make_tracer(const Tree& tree, Backend backend);
// The pairs of accelerator and builder in a study; an accelerator without a tree has the builder "".
std::vector<std::pair<std::string, std::string>> trees_of(const RayStudy& study);

// The ray sets of a study: those in `given` of the requested classes, or generated ones.
std::vector<RaySet> ray_sets_of(const RayMesh& mesh, BatchTracer& tracer, const RayStudy& study);

struct MeshResult {
    nlohmann::ordered_json json;
    std::vector<RaySet> sets;
    std::vector<std::uint64_t> hits;  // number of rays that hit in each set
    bool agrees = true;               // whether all kernels and brute force found equal hits
};

MeshResult measure(const RayMesh& mesh, const RayStudy& study);

// A table of the ray rates that `measure` found, one line per batch.
std::string table_of(const nlohmann::ordered_json& mesh);

}  // namespace pt::rays
