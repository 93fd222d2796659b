// Nodes until there is a leaf, then its triangles: "while-while" of Aila and Laine, "Understanding the Efficiency of
// Ray Traversal on GPUs", HPG 2009. The loop over steps, for stacks other than `local`; with that one programs have the
// accelerator's own loop, which visits in the same order.
#pragma once

#include "kernels/mesh_view.h"

namespace pt::traversal::while_while {

template <class Accelerator, template <class Open, std::uint32_t most> class Stack>
struct Traversal {
    static constexpr bool is_chosen_at_run_time = false;

    template <class Real, class Leaf, class Counter>
    PT_HD static void traverse(const TreeView& tree, const Vec3<Real>& origin, const Vec3<Real>& direction,
                               const Real& best_t, Leaf&& leaf, Counter& counter) {
        using Walk = typename Accelerator::template Walk<Real>;
        using StackOf = Stack<typename Walk::Open, Walk::most_open>;
        if (tree.node_count == 0) {
            return;
        }
        typename StackOf::Memory memory;
        StackOf stack(memory);
        Walk walk(tree, origin, direction);
        while (true) {
            while (walk.wants_node()) {
                walk.visit_node(best_t, stack, counter);
            }
            if (!walk.has_leaf()) {
                return;
            }
            for (typename Walk::Leaf triangles = walk.leaf(); !triangles.empty();) {
                counter.primitives(1);
                leaf(triangles.take(), 1u);
            }
            walk.pass_leaf(best_t, stack);
        }
    }
};

}  // namespace pt::traversal::while_while
