// The tree of the axis `levels`: over all objects that show meshes (a TLAS), or over all their triangles. Trees of the
// scenes rendered last are cached, like the trees of single meshes.
#pragma once

#include "harness/scene/mesh_geometry.h"
#include "kernels/scene_view.h"

namespace pt {

struct SceneTree {
    std::vector<ObjectNode> nodes;
    float margin = 0;  // growth of nodes' boxes, in multiples of a ray origin's largest coordinate (ObjectTree::margin)
    EncodedTree flat;
    std::vector<FlatSlot> slots;
    double build_ms = 0;               // host time in ms to compute bounding boxes and build the tree over all meshes
    double encode_ms = 0;              // time in ms to convert the tree over all meshes to the accelerator's format
    std::vector<MeshGeometry> meshes;  // the scene's meshes, kept alive as long as the tree

    std::uint64_t node_count() const { return nodes.size() + flat.node_count; }
    std::uint64_t node_bytes() const {
        return nodes.size() * sizeof(ObjectNode) + flat.nodes.size() * sizeof(NodePiece);
    }
    std::uint64_t slot_bytes() const { return slots.size() * sizeof(FlatSlot); }
    std::uint64_t bytes() const { return node_bytes() + slot_bytes(); }
    std::size_t kept_bytes() const { return bytes(); }
    ObjectTree objects_view() const;
    FlatTree flat_view() const;
};

// Most triangle slots of a tree over all triangles. A scene with more triangles, instances included, is refused.
inline constexpr std::uint64_t most_flat_slots = std::uint64_t{1} << 25;

// Builds the tree over all meshes of a scene, or null where the choice of `levels` has none. meshes[i] is the geometry
// of the i-th object that shows a mesh. Throws InputError.
template <class Real>
std::shared_ptr<const SceneTree> scene_tree_of(const SceneView<Real>& scene, const std::vector<MeshGeometry>& meshes,
                                               const Acceleration& acceleration);

// Adds the size and build times of the tree over all meshes to `facts`.
void add_facts(MeshFacts& facts, const SceneTree* tree);

}  // namespace pt
