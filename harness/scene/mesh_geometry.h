// The geometry of a mesh as kernels read it: placed triangles and the accelerator's tree over them. Both are built once
// and cached, since a study renders the same scene many times.
#pragma once

#include <memory>

#include "harness/scene/scene_mesh.h"
#include "variants/bvh/hooks.h"
#include "variants/descriptor.h"

namespace pt {

// How trees over meshes are built: the choices of the axes accelerator, builder and levels, by their names, which are
// part of the cache key, and by their hooks.
struct Acceleration {
    std::string accelerator, builder;
    AcceleratorHook accelerator_hook;
    BuilderHook builder_hook;
    std::string levels = "each_object";
    LevelsHook levels_hook = {};

    // The accelerator, builder and levels that a variant chooses. none() is brute force.
    static Acceleration of(const Variant& variant, Backend backend);
    static Acceleration none();
};

// A mesh's triangles, in scene space relative to the eye or, if several objects share the mesh, in its own space.
struct PlacedMesh {
    std::vector<Triangle<float>> triangles;
    std::vector<float> cumulative_area;
    double area = 0;
    Box bounds;

    std::size_t kept_bytes() const { return triangles.size() * (sizeof(Triangle<float>) + sizeof(float)); }
};

struct MeshTree {
    std::vector<LeafTriangle> leaves;
    EncodedTree encoded;
    NativeMesh native;
    double build_ms = 0;      // host time in ms to build the mesh's tree
    double encode_ms = 0;     // time in ms to convert the mesh's tree to the accelerator's format
    double sah_cost = 0;      // SAH cost of the builder's tree; 0: no tree
    std::uint64_t bytes = 0;  // bytes of the mesh's tree: nodes, leaves and native data

    std::size_t kept_bytes() const { return bytes; }
};

struct MeshGeometry {
    std::shared_ptr<const PlacedMesh> placed;
    std::shared_ptr<const MeshTree> tree;

    MeshView view() const;
};

// Size and build times of all meshes of a scene, for results; a mesh that several objects share counts once.
struct MeshFacts {
    std::uint64_t triangles = 0;
    std::uint64_t nodes = 0;
    std::uint64_t node_bytes = 0;
    std::uint64_t leaf_bytes = 0;  // bytes of triangles in all trees' leaves, duplicates included
    double build_ms = 0;           // host time in ms to build the trees of all meshes; 0: no tree
    double encode_ms = 0;
    double sah_cost = 0;  // SAH cost of the largest mesh's tree
    // Number of nodes of the tree that the axis `levels` builds, over objects or over all triangles; 0: no such tree.
    std::uint64_t level_nodes = 0;
    std::uint64_t level_bytes = 0;  // bytes of nodes and triangle slots of the tree over all meshes
    double level_build_ms = 0;      // host time in ms to build and encode the tree over all meshes
};
MeshFacts facts_of(const std::vector<MeshGeometry>& meshes);

// Makes the placed triangles of a mesh and the tree over them. Without a `placement` they are in the mesh's own space.
MeshGeometry geometry_of(const std::shared_ptr<const SceneMesh>& mesh, const Placement* placement,
                         const Acceleration& acceleration);

}  // namespace pt
