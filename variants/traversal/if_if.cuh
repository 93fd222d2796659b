// One loop, each turn of which takes no more than a step through a node and a test of a triangle: "if-if" of Aila and
// Laine, "Understanding the Efficiency of Ray Traversal on GPUs", HPG 2009. No lane waits for the end of another's
// inner loop.
#pragma once

#include "kernels/mesh_view.h"

namespace pt::traversal::if_if {

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
        typename Walk::Leaf triangles;
        while (walk.wants_node() || walk.has_leaf()) {
            if (walk.wants_node()) {
                walk.visit_node(best_t, stack, counter);
                if (walk.has_leaf()) {
                    triangles = walk.leaf();
                }
            }
            if (walk.has_leaf()) {
                counter.primitives(1);
                leaf(triangles.take(), 1u);
                if (triangles.empty()) {
                    walk.pass_leaf(best_t, stack);
                    if (walk.has_leaf()) {
                        triangles = walk.leaf();
                    }
                }
            }
        }
    }
};

}  // namespace pt::traversal::if_if
