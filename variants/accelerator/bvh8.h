// The accelerator bvh8: a tree of eight children a node, single-precision boxes, 256-byte nodes; the nearest child
// first. Wald, Benthin, Boulos, "Getting Rid of Packets", RT 2008; Ernst and Greiner, "Multi Bounding Volume
// Hierarchies", 2008.
#pragma once

#include "variants/bvh/wide_nodes.h"

namespace pt::accelerator::bvh8 {

using Node = WideNode<8>;
static_assert(sizeof(Node) == 256);

#if !defined(__CUDACC_RTC__)
// Encodes a binary tree as bvh8 nodes. Throws std::length_error for one too deep, too large, or with too large leaves.
inline EncodedTree encode(const BinaryTree& tree) { return encode_wide<8>(tree); }
#endif

template <class Real, class Leaf, class Counter>
PT_HD void traverse(const TreeView& tree, const Vec3<Real>& origin, const Vec3<Real>& direction, const Real& best_t,
                    Leaf&& leaf, Counter& counter) {
    traverse_wide<8>(tree, origin, direction, best_t, leaf, counter);
}

struct Traversal {
    static constexpr bool is_chosen_at_run_time = false;
    template <class Real>
    using Walk = WideWalk<8, Real>;

    template <class Real, class Leaf, class Counter>
    PT_HD static void traverse(const TreeView& tree, const Vec3<Real>& origin, const Vec3<Real>& direction,
                               const Real& best_t, Leaf&& leaf, Counter& counter) {
        bvh8::traverse(tree, origin, direction, best_t, leaf, counter);
    }
};

}  // namespace pt::accelerator::bvh8

#if defined(PT_HOST)

#include "variants/bvh/wide_packets.h"
#include "variants/mesh_reasons.h"
#include "variants/registry.h"

namespace pt::accelerator::bvh8 {
namespace {

const Registration registration(
    {
        .axis = "accelerator",
        .name = "bvh8",
        .summary = "tree of eight children a node, 256-byte nodes, the nearest child first",
        .origin = "Wald, Boulos and Benthin 2008",
        .traits = AcceleratorTraits{.has_steps = true},
        .backends = on_every_backend,
        .unsupported_reason = needs_meshes,
    },
    {.accelerator = lanes::accelerator_hook<8, Traversal>(encode)});

}  // namespace
}  // namespace pt::accelerator::bvh8

#endif
