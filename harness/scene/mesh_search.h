// The tree of the axis `levels` over a scene's objects that show meshes, or over all their triangles. Made once and
// kept for the scenes that were rendered last, as the trees of meshes are.
#pragma once

#include "harness/scene/mesh_geometry.h"
#include "kernels/scene_view.h"

namespace pt {

struct SceneTree {
    std::vector<ObjectNode> nodes;
    float margin = 0;  // ObjectTree::margin
    EncodedTree flat;
    std::vector<FlatSlot> slots;
    double build_ms = 0;               // boxes and tree
    double encode_ms = 0;              // into the accelerator's format
    std::vector<MeshGeometry> meshes;  // that it is of

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

// Most slots of a flat tree; a scene with more triangles, instances included, is refused.
inline constexpr std::uint64_t most_flat_slots = std::uint64_t{1} << 25;

// The tree over all meshes; null where the choice has none. `meshes`: by number of the objects that show one. Throws
// InputError.
template <class Real>
std::shared_ptr<const SceneTree> scene_tree_of(const SceneView<Real>& scene, const std::vector<MeshGeometry>& meshes,
                                               const Acceleration& acceleration);

// Adds what the tree takes.
void add_facts(MeshFacts& facts, const SceneTree* tree);

}  // namespace pt
