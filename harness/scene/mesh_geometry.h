// What kernels read of a mesh: its triangles where they stand, and the tree of an accelerator over them. Both are made
// once and kept, as long as there is room: a study renders the same scene many times.
#pragma once

#include <memory>

#include "harness/scene/scene_mesh.h"
#include "variants/bvh/hooks.h"
#include "variants/descriptor.h"

namespace pt {

// The trees that meshes get: the hooks of the choices of accelerator, builder and levels, and their names, by which
// trees are kept.
struct Acceleration {
    std::string accelerator, builder;
    AcceleratorHook accelerator_hook;
    BuilderHook builder_hook;
    std::string levels = "each_object";
    LevelsHook levels_hook = {};

    // The accelerator, builder and levels of a variant; none() is brute force.
    static Acceleration of(const Variant& variant, Backend backend);
    static Acceleration none();
};

// Triangles in one space: that of the scene, relative to the eye, or the mesh's own for objects that share it.
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
    double build_ms = 0;      // by the builder
    double encode_ms = 0;     // into the accelerator's format, and what the accelerator makes for itself
    double sah_cost = 0;      // of the builder's tree; 0: there is none
    std::uint64_t bytes = 0;  // of nodes and leaves, and of what is native

    std::size_t kept_bytes() const { return bytes; }
};

struct MeshGeometry {
    std::shared_ptr<const PlacedMesh> placed;
    std::shared_ptr<const MeshTree> tree;

    MeshView view() const;
};

// What a scene's meshes are to a kernel, all objects together; those that share a mesh count it once.
struct MeshFacts {
    std::uint64_t triangles = 0;
    std::uint64_t nodes = 0;
    std::uint64_t node_bytes = 0;
    std::uint64_t leaf_bytes = 0;  // of the triangles as leaves hold them, duplicates included
    double build_ms = 0;           // on the clock of the host; 0: there is no tree
    double encode_ms = 0;
    double sah_cost = 0;  // of the largest tree
    // Nodes of the top-level tree over objects, or of the tree over the triangles of all objects; 0: there is none.
    std::uint64_t level_nodes = 0;
    std::uint64_t level_bytes = 0;  // of nodes, and of the slots of triangles
    double level_build_ms = 0;      // in its format
};
MeshFacts facts_of(const std::vector<MeshGeometry>& meshes);

// The tree and arrays of a mesh. `placement` null: in the mesh's own space.
MeshGeometry geometry_of(const std::shared_ptr<const SceneMesh>& mesh, const Placement* placement,
                         const Acceleration& acceleration);

}  // namespace pt
