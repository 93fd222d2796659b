// A lane that has found a leaf puts it off and goes on through nodes until all active lanes of its warp have one:
// "speculative while-while" of Aila and Laine, "Understanding the Efficiency of Ray Traversal on GPUs", HPG 2009. What
// a postponed hit would have left out is visited in vain.
#pragma once

#include "kernels/mesh_view.h"

namespace pt::traversal::speculative {

// Of the lanes that ask together. Lanes may ask in parts, by the compiler's will: that changes when leaves are tested,
// not which.
PT_HD inline bool any_lane([[maybe_unused]] bool vote) {
#if defined(__CUDA_ARCH__)
    return __any_sync(__activemask(), vote ? 1 : 0) != 0;
#else
    return vote;
#endif
}

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
        typename Walk::Leaf postponed;
        const auto postpone = [&] {
            if (postponed.empty() && walk.has_leaf()) {
                postponed = walk.leaf();
                walk.pass_leaf(best_t, stack);
            }
        };
        while (walk.wants_node() || !postponed.empty()) {
            while (walk.wants_node()) {
                walk.visit_node(best_t, stack, counter);
                postpone();
                if (!any_lane(postponed.empty())) {
                    break;
                }
            }
            while (!postponed.empty()) {
                counter.primitives(1);
                leaf(postponed.take(), 1u);
                postpone();
            }
        }
    }
};

}  // namespace pt::traversal::speculative
