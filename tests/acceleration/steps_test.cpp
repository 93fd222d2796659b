// Traversals in steps: every order of the steps, and every stack, leaves the hit of the accelerator's own loop, bit for
// bit; where triangles are not put off, after the same work.
#include <type_traits>

#include <gtest/gtest.h>

#include "tests/acceleration/builders.h"
#include "tests/acceleration/closest.h"
#include "tests/acceleration/triangle_scenes.h"
#include "variants/accelerator/bvh2.h"
#include "variants/accelerator/bvh4.h"
#include "variants/accelerator/bvh8.h"
#include "variants/accelerator/cwbvh.h"
#include "variants/bvh/stacks.h"
#include "variants/traversal/if_if.cuh"
#include "variants/traversal/speculative.cuh"
#include "variants/traversal/while_while.cuh"
#include "variants/traversal_stack/local.cuh"

namespace pt::test {
namespace {

template <class Open, std::uint32_t most>
using Local = traversal_stack::local::Stack<Open, most>;
template <std::uint32_t entries>
struct Short {
    template <class Open, std::uint32_t>
    using Stack = typename ShortStackFor<Open, LocalMemory<Open, entries>, entries>::Type;
};

struct Traced {
    std::vector<ClosestHit> closest;
    TraversalCounter work;
};

template <class Traversal>
Traced trace(const EncodedTree& tree, const Triangles& triangles, const std::vector<TestRay>& rays) {
    Traced traced;
    for (const TestRay& ray : rays) {
        traced.closest.push_back(through(
            tree, triangles, ray, [](auto&&... all) { Traversal::template traverse<float>(all...); }, traced.work));
    }
    return traced;
}

void expect_equal(const Traced& found, const Traced& expected) {
    ASSERT_EQ(found.closest.size(), expected.closest.size());
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < found.closest.size(); ++i) {
        wrong += found.closest[i] == expected.closest[i] ? 0 : 1;
    }
    EXPECT_EQ(wrong, 0u);
}

void expect_same_work(const Traced& found, const Traced& expected) {
    EXPECT_EQ(found.work.nodes_visited, expected.work.nodes_visited);
    EXPECT_EQ(found.work.boxes_tested, expected.work.boxes_tested);
    EXPECT_EQ(found.work.primitives_tested, expected.work.primitives_tested);
}

template <class Accelerator>
void expect_same(const EncodedTree& tree, const Triangles& triangles, const std::vector<TestRay>& rays) {
    const Traced own = trace<Accelerator>(tree, triangles, rays);
    for (const Traced& found : {trace<traversal::while_while::Traversal<Accelerator, Local>>(tree, triangles, rays),
                                trace<traversal::if_if::Traversal<Accelerator, Local>>(tree, triangles, rays)}) {
        expect_equal(found, own);
        expect_same_work(found, own);
    }
    const Traced late = trace<traversal::speculative::Traversal<Accelerator, Local>>(tree, triangles, rays);
    expect_equal(late, own);
    EXPECT_GE(late.work.nodes_visited, own.work.nodes_visited);
}

class StepsTest : public testing::TestWithParam<TriangleScene> {
protected:
    const Triangles& triangles() const { return GetParam().triangles; }
    std::vector<TestRay> rays() const { return rays_for(triangles(), 2000, 7); }
    BinaryTree tree(std::uint32_t leaf_size) const {
        return builder::sah_binned::build(boxes_of(triangles()), leaf_size);
    }
};

TEST_P(StepsTest, EveryOrderLeavesTheHitOfTheAcceleratorsOwnLoop) {
    for (const std::uint32_t leaf_size : {1u, 4u}) {
        const BinaryTree binary = tree(leaf_size);
        expect_same<accelerator::bvh2::Traversal>(accelerator::bvh2::encode(binary), triangles(), rays());
        expect_same<accelerator::bvh4::Traversal>(accelerator::bvh4::encode(binary), triangles(), rays());
        expect_same<accelerator::bvh8::Traversal>(accelerator::bvh8::encode(binary), triangles(), rays());
        expect_same<accelerator::cwbvh::Traversal>(accelerator::cwbvh::encode(binary), triangles(), rays());
    }
}

template <class Accelerator, template <class, template <class, std::uint32_t> class> class Loop, std::uint32_t entries>
Traced with_short_stack(const EncodedTree& tree, const Triangles& triangles, const std::vector<TestRay>& rays) {
    return trace<Loop<Accelerator, Short<entries>::template Stack>>(tree, triangles, rays);
}

// Expects short stacks to find the same hits. With as many entries as can wait there is no restart, and the work of a
// whole stack; with one entry there are restarts all the time.
template <class Accelerator>
void expect_short_stacks_find_their_way(const EncodedTree& encoded, const Triangles& triangles,
                                        const std::vector<TestRay>& rays) {
    using namespace traversal;
    constexpr std::uint32_t most_open = Accelerator::template Walk<float>::most_open;
    const Traced own = trace<Accelerator>(encoded, triangles, rays);
    const Traced whole = with_short_stack<Accelerator, while_while::Traversal, most_open>(encoded, triangles, rays);
    expect_equal(whole, own);
    expect_same_work(whole, own);
    const Traced four = with_short_stack<Accelerator, while_while::Traversal, 4>(encoded, triangles, rays);
    const Traced one = with_short_stack<Accelerator, if_if::Traversal, 1>(encoded, triangles, rays);
    const Traced late = with_short_stack<Accelerator, speculative::Traversal, 2>(encoded, triangles, rays);
    for (const Traced& found : {four, one, late}) {
        expect_equal(found, own);
    }
    if constexpr (std::is_same_v<Accelerator, accelerator::cwbvh::Traversal>) {
        // On the way back boxes are held against a nearer hit and triangles are not tested again: there is less to do.
        EXPECT_LE(four.work.primitives_tested, own.work.primitives_tested);
        EXPECT_LE(one.work.primitives_tested, own.work.primitives_tested);
        return;
    }
    for (const Traced& found : {four, one, late}) {
        EXPECT_GE(found.work.nodes_visited, own.work.nodes_visited);
    }
    EXPECT_GE(one.work.nodes_visited, four.work.nodes_visited);
    if constexpr (!std::is_same_v<Accelerator, accelerator::bvh2::Traversal>) {
        // The way back leads past the leaves that were visited.
        EXPECT_EQ(four.work.primitives_tested, own.work.primitives_tested);
        EXPECT_EQ(one.work.primitives_tested, own.work.primitives_tested);
    }
}

TEST_P(StepsTest, ShortStacksFindTheirWay) {
    expect_short_stacks_find_their_way<accelerator::bvh2::Traversal>(accelerator::bvh2::encode(tree(1)), triangles(),
                                                                     rays());
}

TEST_P(StepsTest, ShortStacksFindTheirWayAmongChildrenInOrder) {
    expect_short_stacks_find_their_way<accelerator::bvh4::Traversal>(accelerator::bvh4::encode(tree(1)), triangles(),
                                                                     rays());
    expect_short_stacks_find_their_way<accelerator::bvh8::Traversal>(accelerator::bvh8::encode(tree(2)), triangles(),
                                                                     rays());
}

TEST_P(StepsTest, ShortStacksFindTheirWayAmongGroups) {
    expect_short_stacks_find_their_way<accelerator::cwbvh::Traversal>(accelerator::cwbvh::encode(tree(1)), triangles(),
                                                                      rays());
}

INSTANTIATE_TEST_SUITE_P(Scenes, StepsTest, testing::ValuesIn(triangle_scenes()),
                         [](const auto& scene) { return scene.param.name; });

// Every ray meets every leaf of a chain of 64 levels, the most that are allowed: each bit of the trail is used, and the
// carry out of the last ends the walk.
TEST(ShortStackTest, DeepestTreeEndsAtTheLastBit) {
    const Triangles triangles = equal_triangles(65);
    BinaryTree chain;
    const Box box = boxes_of(triangles)[0];
    chain.nodes.push_back({box, 1, 0});
    for (std::uint32_t level = 1; level <= 64; ++level) {
        chain.nodes.push_back({box, level - 1, 1});
        chain.references.push_back(level - 1);
        chain.nodes.push_back({box, level == 64 ? 64 : 2 * level + 1, level == 64 ? 1u : 0u});
    }
    chain.references.push_back(64);
    const EncodedTree tree = accelerator::bvh2::encode(chain);
    const std::vector<TestRay> rays{{{0.25f, 0.25f, -1}, {0, 0, 1}}};
    const Traced own = trace<accelerator::bvh2::Traversal>(tree, triangles, rays);
    const Traced one =
        with_short_stack<accelerator::bvh2::Traversal, traversal::while_while::Traversal, 1>(tree, triangles, rays);
    expect_equal(one, own);
    EXPECT_EQ(one.work.primitives_tested, own.work.primitives_tested);
}

TEST(ShortStackTest, RestartsWhereItHasForgotten) {
    const Triangles triangles = random_soup(4000, 0.3f, 5);
    const EncodedTree tree = accelerator::bvh2::encode(builder::sah_binned::build(boxes_of(triangles), 1));
    const std::vector<TestRay> rays = rays_for(triangles, 2000, 3);
    const Traced own = trace<accelerator::bvh2::Traversal>(tree, triangles, rays);
    const Traced one =
        with_short_stack<accelerator::bvh2::Traversal, traversal::while_while::Traversal, 1>(tree, triangles, rays);
    expect_equal(one, own);
    EXPECT_GT(one.work.nodes_visited, own.work.nodes_visited);
    // Laine 2010: what is visited again is some of the way down, never whole subtrees.
    EXPECT_LT(one.work.primitives_tested, 2 * own.work.primitives_tested);
}

template <class Accelerator>
void expect_restarts(const EncodedTree& tree, const Triangles& triangles, const std::vector<TestRay>& rays) {
    const Traced own = trace<Accelerator>(tree, triangles, rays);
    const Traced one = with_short_stack<Accelerator, traversal::while_while::Traversal, 1>(tree, triangles, rays);
    const Traced two = with_short_stack<Accelerator, traversal::while_while::Traversal, 2>(tree, triangles, rays);
    for (const Traced& found : {one, two}) {
        expect_equal(found, own);
        EXPECT_LE(found.work.primitives_tested, own.work.primitives_tested);
    }
    EXPECT_GT(one.work.nodes_visited, two.work.nodes_visited);
    EXPECT_GT(one.work.nodes_visited, own.work.nodes_visited);
}

TEST(ShortStackTest, RestartsInWideTreesWhereItHasForgotten) {
    const Triangles triangles = random_soup(20000, 0.3f, 5);
    const BinaryTree binary = builder::sah_binned::build(boxes_of(triangles), 1);
    const std::vector<TestRay> rays = rays_for(triangles, 2000, 3);
    expect_restarts<accelerator::bvh4::Traversal>(accelerator::bvh4::encode(binary), triangles, rays);
    expect_restarts<accelerator::bvh8::Traversal>(accelerator::bvh8::encode(binary), triangles, rays);
    expect_restarts<accelerator::cwbvh::Traversal>(accelerator::cwbvh::encode(binary), triangles, rays);
}

// A group of two waits at every level down to the 64th, nothing is hit: each bit of the trail is used, and the walk
// enters every child exactly once, in order.
TEST(ShortGroupStackTest, EveryLevelIsFoundAgain) {
    using accelerator::cwbvh::NodeGroup;
    for (const std::uint32_t entries_are_one : {0u, 1u}) {
        LocalMemory<NodeGroup, 1> one_entry;
        LocalMemory<NodeGroup, 64> all_entries;
        ShortGroupStack<NodeGroup, LocalMemory<NodeGroup, 1>, 1> one(one_entry);
        ShortGroupStack<NodeGroup, LocalMemory<NodeGroup, 64>, 64> all(all_entries);
        // A node is its level (base); each has two children at positions that differ by level, the last none.
        const auto children_of = [](std::uint32_t level) {
            const std::uint32_t high = 1 + level % 7;
            return level == 64 ? NodeGroup{level, 0} : NodeGroup{level, (1u << (24 + high)) | (1u << 24)};
        };
        std::vector<std::pair<std::uint32_t, std::uint32_t>> entered;  // level of the group, position
        const auto walk = [&](auto& stack) {
            for (NodeGroup group = NodeGroup::root(); !group.empty();) {
                const std::uint32_t position = group.nearest(), parent = group.base;
                const bool is_root = group.bits == NodeGroup::root().bits && parent == 0;
                group.bits &= ~(1u << (24 + position));
                const bool was_here = stack.enter(position, group);
                if (!was_here && !is_root) {
                    entered.emplace_back(parent, position);
                }
                // The lower child has no children of its own.
                const std::uint32_t level = is_root ? 0 : parent + 1;
                group = is_root || position != 0 ? children_of(level) : NodeGroup{level, 0};
                stack.narrow(group);
                if (group.empty() && !stack.pop(group)) {
                    group = {};
                }
            }
        };
        entries_are_one != 0 ? walk(one) : walk(all);
        ASSERT_EQ(entered.size(), 128u) << entries_are_one;
        for (std::uint32_t level = 0; level < 64; ++level) {
            EXPECT_EQ(entered[level], std::pair(level, 1 + level % 7));
            EXPECT_EQ(entered[127 - level], std::pair(level, 0u));
        }
    }
}

template <class Accelerator, template <class Open, std::uint32_t most> class Stack>
std::uint64_t nodes_until_a_negative_best(const EncodedTree& tree) {
    float best = std::numeric_limits<float>::infinity();
    TraversalCounter counter;
    const auto leaf = [&](std::uint32_t, std::uint32_t) { best = -1; };
    traversal::if_if::Traversal<Accelerator, Stack>::template traverse<float>(tree.view(), {0.25f, 0.25f, -1},
                                                                              {0, 0, 1}, best, leaf, counter);
    return counter.nodes_visited;
}

template <class Accelerator>
void expect_negative_best_ends_the_walk(const EncodedTree& tree) {
    EXPECT_LE((nodes_until_a_negative_best<Accelerator, Local>(tree)), 64u);
    EXPECT_LE((nodes_until_a_negative_best<Accelerator, Short<1>::template Stack>(tree)), 64u);
}

TEST(StepsTest, NegativeBestEndsTheWalk) {
    const Triangles triangles = equal_triangles(1000);
    const BinaryTree binary = builder::sah_binned::build(boxes_of(triangles), 1);
    expect_negative_best_ends_the_walk<accelerator::bvh2::Traversal>(accelerator::bvh2::encode(binary));
    expect_negative_best_ends_the_walk<accelerator::bvh4::Traversal>(accelerator::bvh4::encode(binary));
    expect_negative_best_ends_the_walk<accelerator::bvh8::Traversal>(accelerator::bvh8::encode(binary));
    expect_negative_best_ends_the_walk<accelerator::cwbvh::Traversal>(accelerator::cwbvh::encode(binary));
}

}  // namespace
}  // namespace pt::test
