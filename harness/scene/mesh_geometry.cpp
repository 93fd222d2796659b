#include "harness/scene/mesh_geometry.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <set>
#include <string>

#include "harness/scene/keeper.h"
#include "variants/builder/sah.h"

namespace pt {

namespace {

double area_of(const Triangle<float>& t) {
    const Vec3d a(t.a);
    const Vec3d normal = cross(Vec3d(t.b) - a, Vec3d(t.c) - a);
    return 0.5 * std::sqrt(dot(normal, normal));
}

PlacedMesh place(const SceneMesh& mesh, const Placement* placement) {
    PlacedMesh placed;
    placed.triangles = placement != nullptr ? placed_triangles(mesh, *placement) : mesh.triangles;
    placed.cumulative_area.reserve(placed.triangles.size());
    for (const Triangle<float>& t : placed.triangles) {
        placed.area += area_of(t);
        placed.cumulative_area.push_back(static_cast<float>(placed.area));
        const Box box = box_round(t);
        for (int axis = 0; axis < 3; ++axis) {
            placed.bounds.low[axis] = std::min(placed.bounds.low[axis], box.low[axis]);
            placed.bounds.high[axis] = std::max(placed.bounds.high[axis], box.high[axis]);
        }
    }
    return placed;
}

MeshTree plant(const PlacedMesh& placed, const Acceleration& acceleration) {
    MeshTree tree;
    const std::vector<Triangle<float>>& triangles = placed.triangles;
    if (acceleration.accelerator_hook.encode == nullptr) {
        for (std::uint32_t i = 0; i < triangles.size(); ++i) {
            tree.leaves.push_back(LeafTriangle::of(triangles[i], i));
        }
    } else {
        PrimitiveBoxes boxes(triangles.size());
        std::transform(triangles.begin(), triangles.end(), boxes.begin(),
                       [](const Triangle<float>& t) { return box_round(t); });
        auto start = std::chrono::steady_clock::now();
        const BinaryTree binary = acceleration.builder_hook.build(boxes, triangles);
        tree.build_ms = milliseconds_since(start);
        tree.sah_cost = builder::tree_cost(binary);
        start = std::chrono::steady_clock::now();
        tree.encoded = acceleration.accelerator_hook.encode(binary);
        tree.encode_ms = milliseconds_since(start);
        for (const std::uint32_t primitive : tree.encoded.references) {
            tree.leaves.push_back(LeafTriangle::of(triangles[primitive], primitive));
        }
    }
    if (acceleration.accelerator_hook.prepare != nullptr) {
        const auto start = std::chrono::steady_clock::now();
        tree.native = acceleration.accelerator_hook.prepare(tree.encoded, tree.leaves);
        tree.encode_ms += milliseconds_since(start);
    }
    tree.bytes =
        tree.leaves.size() * sizeof(LeafTriangle) + tree.encoded.nodes.size() * sizeof(NodePiece) + tree.native.bytes;
    return tree;
}

std::string key_of(const SceneMesh& mesh, const Placement* placement) {
    std::string key = mesh.hash + std::to_string(mesh.triangles.size());
    if (placement != nullptr) {
        for (const Vec3d& v :
             {placement->centre, placement->column[0], placement->column[1], placement->column[2], placement->scale}) {
            key.append(reinterpret_cast<const char*>(&v), sizeof v);
        }
    }
    return key;
}

}  // namespace

Acceleration Acceleration::none() { return {"brute_force", "", pt::accelerator_hook<BruteForce>(nullptr), {}}; }

MeshView MeshGeometry::view() const {
    MeshView view;
    view.leaves = tree->leaves.data();
    view.triangles = placed->triangles.data();
    view.cumulative_area = placed->cumulative_area.data();
    view.tree = tree->encoded.view();
    view.tree.slot_count = static_cast<std::uint32_t>(tree->leaves.size());
    view.native = tree->native.data.get();
    view.triangle_count = static_cast<std::uint32_t>(placed->triangles.size());
    return view;
}

MeshGeometry geometry_of(const std::shared_ptr<const SceneMesh>& mesh, const Placement* placement,
                         const Acceleration& acceleration) {
    static Keeper<PlacedMesh> placed_meshes;
    static Keeper<MeshTree> trees;
    const std::string key = key_of(*mesh, placement);
    MeshGeometry geometry;
    geometry.placed = placed_meshes.get(key, [&] { return place(*mesh, placement); });
    const char* native = acceleration.accelerator_hook.prepare != nullptr ? " native" : "";
    geometry.tree = trees.get(key + " " + acceleration.accelerator + " " + acceleration.builder + native,
                              [&] { return plant(*geometry.placed, acceleration); });
    return geometry;
}

MeshFacts facts_of(const std::vector<MeshGeometry>& meshes) {
    MeshFacts facts;
    std::set<const MeshTree*> counted;
    std::size_t largest = 0;
    for (const MeshGeometry& mesh : meshes) {
        const MeshTree& tree = *mesh.tree;
        if (!counted.insert(&tree).second) {
            continue;
        }
        facts.triangles += mesh.placed->triangles.size();
        facts.nodes += tree.encoded.node_count;
        facts.node_bytes += tree.encoded.nodes.size() * sizeof(NodePiece);
        facts.leaf_bytes += tree.leaves.size() * sizeof(LeafTriangle);
        facts.build_ms += tree.build_ms;
        facts.encode_ms += tree.encode_ms;
        if (mesh.placed->triangles.size() > largest) {
            largest = mesh.placed->triangles.size();
            facts.sah_cost = tree.sah_cost;
        }
    }
    return facts;
}

}  // namespace pt
