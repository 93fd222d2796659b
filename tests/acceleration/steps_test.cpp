// Traversals in steps: every order of the steps, and every stack, leaves the hit of the accelerator's own loop, bit for
// bit; where triangles are not put off, after the same work.
#include <gtest/gtest.h>

#include "tests/acceleration/builders.h"
#include "tests/acceleration/closest.h"
#include "tests/acceleration/triangle_scenes.h"
#include "variants/acceleration/stacks.h"
#include "variants/accelerator/bvh2.h"
#include "variants/accelerator/bvh4.h"
#include "variants/accelerator/bvh8.h"
#include "variants/accelerator/cwbvh.h"
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
    using Stack = ShortStack<Open, LocalMemory<Open, entries>, entries>;
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

template <template <class, template <class, std::uint32_t> class> class Loop, std::uint32_t entries>
Traced with_short_stack(const EncodedTree& tree, const Triangles& triangles, const std::vector<TestRay>& rays) {
    return trace<Loop<accelerator::bvh2::Traversal, Short<entries>::template Stack>>(tree, triangles, rays);
}

// 64 entries hold all that waits: no restart, and the work of a whole stack. One entry: restarts all the time.
TEST_P(StepsTest, ShortStacksFindTheirWay) {
    using accelerator::bvh2::Traversal;
    const EncodedTree encoded = accelerator::bvh2::encode(tree(1));
    const Traced own = trace<Traversal>(encoded, triangles(), rays());
    const Traced whole = with_short_stack<traversal::while_while::Traversal, 64>(encoded, triangles(), rays());
    expect_equal(whole, own);
    expect_same_work(whole, own);
    const Traced four = with_short_stack<traversal::while_while::Traversal, 4>(encoded, triangles(), rays());
    const Traced one = with_short_stack<traversal::if_if::Traversal, 1>(encoded, triangles(), rays());
    const Traced late = with_short_stack<traversal::speculative::Traversal, 2>(encoded, triangles(), rays());
    for (const Traced& found : {four, one, late}) {
        expect_equal(found, own);
        EXPECT_GE(found.work.nodes_visited, own.work.nodes_visited);
    }
    EXPECT_GE(one.work.nodes_visited, four.work.nodes_visited);
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
    const Traced one = with_short_stack<traversal::while_while::Traversal, 1>(tree, triangles, rays);
    expect_equal(one, own);
    EXPECT_EQ(one.work.primitives_tested, own.work.primitives_tested);
}

TEST(ShortStackTest, RestartsWhereItHasForgotten) {
    const Triangles triangles = random_soup(4000, 0.3f, 5);
    const EncodedTree tree = accelerator::bvh2::encode(builder::sah_binned::build(boxes_of(triangles), 1));
    const std::vector<TestRay> rays = rays_for(triangles, 2000, 3);
    const Traced own = trace<accelerator::bvh2::Traversal>(tree, triangles, rays);
    const Traced one = with_short_stack<traversal::while_while::Traversal, 1>(tree, triangles, rays);
    expect_equal(one, own);
    EXPECT_GT(one.work.nodes_visited, own.work.nodes_visited);
    // Laine 2010: what is visited again is some of the way down, never whole subtrees.
    EXPECT_LT(one.work.primitives_tested, 2 * own.work.primitives_tested);
}

TEST(StepsTest, NegativeBestEndsTheWalk) {
    const Triangles triangles = equal_triangles(1000);
    const BinaryTree binary = builder::sah_binned::build(boxes_of(triangles), 1);
    const auto nodes_visited = [&]<class Accelerator>(const EncodedTree& tree, Accelerator) {
        float best = std::numeric_limits<float>::infinity();
        TraversalCounter counter;
        const auto leaf = [&](std::uint32_t, std::uint32_t) { best = -1; };
        traversal::if_if::Traversal<Accelerator, Local>::template traverse<float>(tree.view(), {0.25f, 0.25f, -1},
                                                                                  {0, 0, 1}, best, leaf, counter);
        return counter.nodes_visited;
    };
    const auto bvh2 = accelerator::bvh2::encode(binary);
    EXPECT_LE(nodes_visited(bvh2, accelerator::bvh2::Traversal()), 64u);
    EXPECT_LE(nodes_visited(accelerator::cwbvh::encode(binary), accelerator::cwbvh::Traversal()), 64u);
}

}  // namespace
}  // namespace pt::test
