#include "harness/scene/mesh_search.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "harness/failure.h"
#include "harness/scene/instance_boxes.h"
#include "harness/scene/keeper.h"

namespace pt {

namespace {

template <class T>
void append_bytes(std::string& key, const T& value) {
    key.append(reinterpret_cast<const char*>(&value), sizeof value);
}

// Cache key of a tree over all meshes of a scene: everything that the tree depends on. Meshes are identified by
// address, which cannot be reused as long as the tree keeps the mesh alive.
template <class Real>
std::string key_of(const SceneView<Real>& scene, const std::vector<MeshGeometry>& meshes,
                   const Acceleration& acceleration, double farthest) {
    std::string key =
        fmt::format("{} {} {} {} ", acceleration.levels, acceleration.accelerator, acceleration.builder, sizeof(Real));
    append_bytes(key, farthest);
    append_bytes(key, scene.camera.shutter_open);
    append_bytes(key, scene.camera.shutter_length);
    for (std::uint32_t i = 0; i < scene.meshes.size; ++i) {
        const MeshInstance<Real>& instance = scene.meshes[i];
        append_bytes(key, meshes[i].placed.get());
        append_bytes(key, instance.row);
        append_bytes(key, instance.offset);
        append_bytes(key, instance.is_placed);
        append_bytes(key, scene.velocity[first_of<ShapeKind::mesh>(scene) + i]);
    }
    return key;
}

// Motion of a mesh in the shutter interval, widened since a ray's time is rounded when interpolated between its ends.
template <class Real>
Sweep sweep_of(const SceneView<Real>& scene, std::uint32_t mesh) {
    const auto open = static_cast<double>(scene.camera.shutter_open);
    const double close = open + static_cast<double>(scene.camera.shutter_length);
    const double rounding = gamma<float>(8) * std::max(std::abs(open), std::abs(close));
    return {Vec3d(scene.velocity[first_of<ShapeKind::mesh>(scene) + mesh]), open - rounding, close + rounding};
}

template <class Real>
std::vector<InstanceBoxes> boxes_of(const SceneView<Real>& scene, const std::vector<MeshGeometry>& meshes) {
    std::vector<InstanceBoxes> boxes;
    boxes.reserve(scene.meshes.size);
    for (std::uint32_t i = 0; i < scene.meshes.size; ++i) {
        boxes.emplace_back(scene.meshes[i], meshes[i].placed->bounds, sweep_of(scene, i));
    }
    return boxes;
}

void plant_over_objects(SceneTree& tree, const std::vector<InstanceBoxes>& instances, const LevelsHook& hook) {
    const auto start = std::chrono::steady_clock::now();
    PrimitiveBoxes boxes;
    double margin = 0;
    for (const InstanceBoxes& instance : instances) {
        boxes.push_back(instance.box());
        margin = std::max(margin, instance.margin_by_origin());
    }
    tree.nodes = hook.build(boxes);
    // The growth of the tree's boxes also covers four roundings of the ray-box test and those of computing the growth.
    tree.margin = static_cast<float>(margin + gamma<float>(8)) * (1.0f + gamma<float>(4));
    tree.build_ms = milliseconds_since(start);
}

std::vector<FlatSlot> all_triangles(const std::vector<MeshGeometry>& meshes) {
    std::uint64_t count = 0;
    for (const MeshGeometry& mesh : meshes) {
        count += mesh.placed->triangles.size();
    }
    if (count > most_flat_slots) {
        throw InputError(fmt::format("levels=flat: found {} triangles, instances included, allowed: at most {}", count,
                                     most_flat_slots));
    }
    std::vector<FlatSlot> slots;
    slots.reserve(count);
    for (std::uint32_t mesh = 0; mesh < meshes.size(); ++mesh) {
        for (std::uint32_t i = 0; i < meshes[mesh].placed->triangles.size(); ++i) {
            slots.push_back({mesh, i});
        }
    }
    return slots;
}

void plant_flat(SceneTree& tree, const std::vector<InstanceBoxes>& instances, const Acceleration& acceleration,
                double farthest) {
    const std::vector<FlatSlot> slots = all_triangles(tree.meshes);
    auto start = std::chrono::steady_clock::now();
    PrimitiveBoxes boxes(slots.size());
    std::transform(slots.begin(), slots.end(), boxes.begin(), [&](const FlatSlot& slot) {
        return instances[slot.mesh].box(tree.meshes[slot.mesh].placed->triangles[slot.primitive], farthest);
    });
    const BinaryTree binary = acceleration.builder_hook.build(boxes, {});
    tree.build_ms = milliseconds_since(start);
    start = std::chrono::steady_clock::now();
    tree.flat = acceleration.accelerator_hook.encode(binary);
    tree.slots.resize(tree.flat.references.size());
    std::transform(tree.flat.references.begin(), tree.flat.references.end(), tree.slots.begin(),
                   [&](std::uint32_t reference) { return slots[reference]; });
    tree.flat.references = {};
    tree.encode_ms = milliseconds_since(start);
}

}  // namespace

ObjectTree SceneTree::objects_view() const { return {nodes.data(), static_cast<std::uint32_t>(nodes.size()), margin}; }

FlatTree SceneTree::flat_view() const {
    FlatTree view{flat.view(), slots.data()};
    view.tree.slot_count = static_cast<std::uint32_t>(slots.size());
    return view;
}

template <class Real>
std::shared_ptr<const SceneTree> scene_tree_of(const SceneView<Real>& scene, const std::vector<MeshGeometry>& meshes,
                                               const Acceleration& acceleration) {
    const LevelsHook& hook = acceleration.levels_hook;
    if ((hook.build == nullptr && !hook.is_flat) || meshes.empty()) {
        return nullptr;
    }
    static Keeper<SceneTree> trees;
    const Sweep sweep = sweep_of(scene, 0);
    const double farthest =
        hook.is_flat ? farthest_origin(scene, std::max(std::abs(sweep.first_time), std::abs(sweep.last_time))) : 0;
    return trees.get(key_of(scene, meshes, acceleration, farthest), [&] {
        SceneTree tree;
        tree.meshes = meshes;
        const std::vector<InstanceBoxes> instances = boxes_of(scene, meshes);
        if (hook.is_flat) {
            plant_flat(tree, instances, acceleration, farthest);
        } else {
            plant_over_objects(tree, instances, hook);
        }
        return tree;
    });
}

void add_facts(MeshFacts& facts, const SceneTree* tree) {
    if (tree == nullptr) {
        return;
    }
    facts.level_nodes = tree->node_count();
    facts.level_bytes = tree->bytes();
    facts.level_build_ms = tree->build_ms + tree->encode_ms;
}

template std::shared_ptr<const SceneTree> scene_tree_of(const SceneView<float>&, const std::vector<MeshGeometry>&,
                                                        const Acceleration&);
template std::shared_ptr<const SceneTree> scene_tree_of(const SceneView<double>&, const std::vector<MeshGeometry>&,
                                                        const Acceleration&);

}  // namespace pt
