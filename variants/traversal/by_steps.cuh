// What traversals share that loop over an accelerator's steps (variants/bvh/walk.h). An Order's run(walk, triangles,
// best_t, stack, leaf, counter) decides which step comes when, until the walk is over; `triangles` are those found and
// yet to be tested, none at first.
#pragma once

#include "kernels/mesh_view.h"

namespace pt::traversal {

template <class Order, class Accelerator, template <class Open, std::uint32_t most> class Stack>
struct BySteps {
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
        typename Walk::Leaf in_hand;
        Order::run(walk, in_hand, best_t, stack, leaf, counter);
    }
};

}  // namespace pt::traversal
