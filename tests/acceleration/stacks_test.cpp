// Short stacks of wide trees by themselves: over made-up trees, whose boxes are numbers, they lead to the leaves of a
// stack that holds all that waits, in its order, wherever the best hit comes nearer on the way.
#include <random>

#include <gtest/gtest.h>

#include "variants/bvh/stacks.h"
#include "variants/traversal/while_while.cuh"

namespace pt::test {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();

template <int width>
struct MadeUpTree {
    struct Node {
        float entry[width];
        std::uint32_t link[width];
    };
    std::vector<Node> nodes;
    std::vector<float> hit;  // of each leaf's slot: where it is met, infinity for nowhere

    std::uint32_t add_leaf(float hit_at) {
        hit.push_back(hit_at);
        return leaf_link(static_cast<std::uint32_t>(hit.size() - 1), 1);
    }
    // Below a box that is entered at `from`; a third of the children is not met, entries are often equal. A triangle
    // may be met before the box of its leaf, as where a spatial split has clipped it: the way back may be out of reach.
    std::uint32_t add_at_random(std::mt19937& random, float from, std::uint32_t levels) {
        const auto number = static_cast<std::uint32_t>(nodes.size());
        nodes.emplace_back();
        for (int child = 0; child < width; ++child) {
            const bool is_met = random() % 3 != 0;
            const float further = static_cast<float>(random() % 4), zero = random() % 2 == 0 ? 0.0f : -0.0f;
            const float entry = from + further == 0 ? zero : from + further;
            const std::uint32_t kind = random() % static_cast<std::uint32_t>(width);
            std::uint32_t link = 0;
            if (is_met && levels > 1 && kind < 2) {
                link = add_at_random(random, entry, levels - 1);
            } else {
                link = add_leaf(kind == 2 ? static_cast<float>(random() % (3 + static_cast<std::uint32_t>(entry)))
                                          : infinity);
            }
            nodes[number].entry[child] = is_met ? entry : -1;
            nodes[number].link[child] = link;
        }
        return number;
    }
    // `levels` nodes one below the other, each beside width - 1 leaves; all are entered at once.
    static MadeUpTree chain(std::uint32_t levels) {
        MadeUpTree tree;
        for (std::uint32_t level = 0; level < levels; ++level) {
            tree.nodes.emplace_back();
            for (std::uint32_t child = 0; child < width; ++child) {
                const bool goes_on = level + 1 < levels && child == level % width;
                tree.nodes[level].entry[child] = (level + child) % 2 == 0 ? 0.0f : -0.0f;
                tree.nodes[level].link[child] = goes_on ? level + 1 : tree.add_leaf(infinity);
            }
        }
        return tree;
    }
};

template <int width>
class MadeUpWalk : public LinkWalk<float, width> {
public:
    explicit MadeUpWalk(const MadeUpTree<width>& tree) : tree_(tree) { this->link_ = 0; }

    template <class Stack, class Counter>
    void visit_node(const float& best_t, Stack& stack, Counter& counter) {
        counter.node();
        const auto& node = tree_.nodes[this->link_];
        float entries[width];
        for (int child = 0; child < width; ++child) {
            entries[child] = node.entry[child] <= best_t ? node.entry[child] : -1;
        }
        if (!stack.enters_nearest(entries, node.link, this->link_)) {
            this->take_open(best_t, stack);
        }
    }

private:
    const MadeUpTree<width>& tree_;
};

struct Way {
    std::vector<std::uint32_t> leaves;
    std::uint64_t nodes = 0;
};

struct NodeCounter {
    std::uint64_t nodes = 0;
    void node() { ++nodes; }
    void primitives(std::uint32_t) {}
};

template <class Stack, int width>
Way way_through(const MadeUpTree<width>& tree) {
    auto memory = std::make_unique<typename Stack::Memory>();
    Stack stack(*memory);
    MadeUpWalk<width> walk(tree);
    SlotRange in_hand;
    float best = infinity;
    Way way;
    NodeCounter counter;
    const auto leaf = [&](std::uint32_t slot, std::uint32_t) {
        way.leaves.push_back(slot);
        best = min(best, tree.hit[slot]);
    };
    traversal::while_while::Order::run(walk, in_hand, best, stack, leaf, counter);
    way.nodes = counter.nodes;
    return way;
}

template <int width>
Way whole_way(const MadeUpTree<width>& tree) {
    using Open = OpenLink<float, width>;
    return way_through<FullStack<Open, LocalMemory<Open, 1 + 32 * (width - 1)>>>(tree);
}

template <std::uint32_t entries, int width>
Way short_way(const MadeUpTree<width>& tree) {
    using Open = OpenLink<float, width>;
    return way_through<typename ShortStackFor<Open, LocalMemory<Open, entries>, entries>::Type>(tree);
}

template <class Width>
class ShortOrderStackTest : public testing::Test {};
using Widths = testing::Types<std::integral_constant<int, 4>, std::integral_constant<int, 8>>;
TYPED_TEST_SUITE(ShortOrderStackTest, Widths);

TYPED_TEST(ShortOrderStackTest, ComesToTheSameLeavesInTheSameOrder) {
    constexpr int width = TypeParam::value;
    std::mt19937 random(19);
    std::uint64_t leaves = 0, nodes = 0, again_by_one = 0, again_by_four = 0;
    for (int repetition = 0; repetition < 3000; ++repetition) {
        MadeUpTree<width> tree;
        tree.add_at_random(random, 0, 6);
        const Way whole = whole_way(tree), one = short_way<1>(tree), four = short_way<4>(tree);
        EXPECT_EQ(one.leaves, whole.leaves);
        EXPECT_EQ(short_way<3>(tree).leaves, whole.leaves);
        EXPECT_EQ(four.leaves, whole.leaves);
        const Way enough = short_way<1 + 32 * (width - 1)>(tree);
        EXPECT_EQ(enough.leaves, whole.leaves);
        EXPECT_EQ(enough.nodes, whole.nodes);
        leaves += whole.leaves.size();
        nodes += whole.nodes;
        again_by_one += one.nodes - whole.nodes;
        again_by_four += four.nodes - whole.nodes;
    }
    EXPECT_GT(leaves, 5000u);  // the trees are not empty, and are walked again
    EXPECT_GT(nodes, 2000u);
    EXPECT_GT(again_by_four, 0u);
    EXPECT_GT(again_by_one, again_by_four);
}

// What waits at a level is forgotten at every level: each bit of the trail is used, down to the last.
TYPED_TEST(ShortOrderStackTest, EveryLevelIsFoundAgain) {
    constexpr int width = TypeParam::value;
    for (const std::uint32_t levels : {1u, 2u, 31u, 32u}) {
        const auto tree = MadeUpTree<width>::chain(levels);
        const Way whole = whole_way(tree);
        EXPECT_EQ(whole.leaves.size(), levels * (width - 1) + 1);
        EXPECT_EQ(short_way<1>(tree).leaves, whole.leaves);
        EXPECT_EQ(short_way<5>(tree).leaves, whole.leaves);
    }
}

// A best below 0 ends a walk (an occluded ray), though much was forgotten.
TYPED_TEST(ShortOrderStackTest, NegativeBestEndsTheWalk) {
    constexpr int width = TypeParam::value;
    auto tree = MadeUpTree<width>::chain(20);
    const Way whole = whole_way(tree);
    tree.hit[whole.leaves[width * 5]] = -1;
    EXPECT_EQ(short_way<1>(tree).leaves, whole_way(tree).leaves);
    EXPECT_EQ(short_way<4>(tree).leaves.size(), width * 5 + 1u);
}

}  // namespace
}  // namespace pt::test
