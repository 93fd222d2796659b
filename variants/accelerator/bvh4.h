// The accelerator bvh4: a tree of four children a node, single-precision boxes, 128-byte nodes; the nearest child
// first. Wald, Benthin, Boulos, "Getting Rid of Packets", RT 2008; Ernst and Greiner, "Multi Bounding Volume
// Hierarchies", 2008.
#pragma once

#include "variants/bvh/wide_nodes.h"

namespace pt::accelerator::bvh4 {

using Node = WideNode<4>;
static_assert(sizeof(Node) == 128);

#if !defined(__CUDACC_RTC__)
// Encodes a binary tree as bvh4 nodes. Throws std::length_error for one too deep, too large, or with too large leaves.
inline EncodedTree encode(const BinaryTree& tree) { return encode_wide<4>(tree); }
#endif

template <class Real, class Leaf, class Counter>
PT_HD void traverse(const TreeView& tree, const Vec3<Real>& origin, const Vec3<Real>& direction, const Real& best_t,
                    Leaf&& leaf, Counter& counter) {
    traverse_wide<4>(tree, origin, direction, best_t, leaf, counter);
}

struct Traversal {
    static constexpr bool is_chosen_at_run_time = false;
    template <class Real>
    using Walk = WideWalk<4, Real>;

    template <class Real, class Leaf, class Counter>
    PT_HD static void traverse(const TreeView& tree, const Vec3<Real>& origin, const Vec3<Real>& direction,
                               const Real& best_t, Leaf&& leaf, Counter& counter) {
        bvh4::traverse(tree, origin, direction, best_t, leaf, counter);
    }
};

}  // namespace pt::accelerator::bvh4

#if defined(PT_HOST)

#include "variants/bvh/wide_packets.h"
#include "variants/mesh_reasons.h"
#include "variants/registry.h"

namespace pt::accelerator::bvh4 {
namespace {

const Registration registration(
    {
        .axis = "accelerator",
        .name = "bvh4",
        .summary = "tree of four children a node, 128-byte nodes, the nearest child first",
        .origin = "Wald, Boulos and Benthin 2008",
        .traits = AcceleratorTraits{.has_steps = true},
        .backends = on_every_backend,
        .unsupported_reason = needs_meshes,
    },
    {.accelerator = lanes::accelerator_hook<4, Traversal>(encode)});

}  // namespace
}  // namespace pt::accelerator::bvh4

#endif
