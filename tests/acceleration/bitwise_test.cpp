// Every builder x accelerator leaves brute force's closest hit, bit for bit: boxes err only towards yes, and ties go to
// the smaller primitive.
#include <gtest/gtest.h>

#include <sstream>

#include "tests/acceleration/builders.h"
#include "tests/acceleration/closest.h"
#include "tests/acceleration/triangle_scenes.h"
#include "variants/accelerator/bvh2.h"
#include "variants/accelerator/bvh4.h"
#include "variants/accelerator/bvh8.h"
#include "variants/accelerator/cwbvh.h"
#include "variants/bvh/box_ray.h"

namespace pt::test {
namespace {

struct AcceleratorChoice {
    std::string name;
    std::function<EncodedTree(const BinaryTree&)> encode;
    std::function<ClosestHit(const EncodedTree&, const Triangles&, const TestRay&, TraversalCounter&)> trace;
};

template <class Encode, class Traverse>
AcceleratorChoice accelerator(const char* name, Encode encode, Traverse traverse) {
    return {name, encode,
            [traverse](const EncodedTree& tree, const Triangles& triangles, const TestRay& ray,
                       TraversalCounter& counter) { return through(tree, triangles, ray, traverse, counter); }};
}

std::vector<AcceleratorChoice> accelerators() {
    return {accelerator("bvh2", &accelerator::bvh2::encode,
                        [](auto&&... all) { accelerator::bvh2::traverse<float>(all...); }),
            accelerator("bvh4", &accelerator::bvh4::encode,
                        [](auto&&... all) { accelerator::bvh4::traverse<float>(all...); }),
            accelerator("bvh8", &accelerator::bvh8::encode,
                        [](auto&&... all) { accelerator::bvh8::traverse<float>(all...); }),
            accelerator("cwbvh", &accelerator::cwbvh::encode,
                        [](auto&&... all) { accelerator::cwbvh::traverse<float>(all...); })};
}

std::string text(const TestRay& ray) {
    std::ostringstream out;
    out << std::hexfloat << "ray " << ray.origin.x << " " << ray.origin.y << " " << ray.origin.z << " -> "
        << ray.direction.x << " " << ray.direction.y << " " << ray.direction.z;
    return out.str();
}

struct Expected {
    std::vector<TestRay> rays;
    std::vector<ClosestHit> closest;
    std::size_t hits = 0;
};

Expected by_brute_force(const Triangles& triangles, std::uint32_t count) {
    Expected expected;
    expected.rays = rays_for(triangles, count, 99);
    for (const TestRay& ray : expected.rays) {
        expected.closest.push_back(brute_force(triangles, ray));
        expected.hits += expected.closest.back().hit.hits ? 1 : 0;
    }
    return expected;
}

class BitwiseTest : public testing::TestWithParam<TriangleScene> {};

TEST_P(BitwiseTest, EveryBuilderAndAcceleratorLeavesBruteForcesHit) {
    const Triangles& triangles = GetParam().triangles;
    const Expected expected = by_brute_force(triangles, 10000);
    EXPECT_GT(expected.hits, expected.rays.size() / 50);
    for (const BuilderChoice& builder : builders()) {
        for (const std::uint32_t leaf_size : {1u, 4u}) {
            const BinaryTree tree = builder.build(triangles, leaf_size);
            for (const AcceleratorChoice& accelerator : accelerators()) {
                const EncodedTree encoded = accelerator.encode(tree);
                TraversalCounter counter;
                std::size_t wrong = 0;
                for (std::size_t i = 0; i < expected.rays.size(); ++i) {
                    const ClosestHit found = accelerator.trace(encoded, triangles, expected.rays[i], counter);
                    if (!(found == expected.closest[i]) && wrong++ < 2) {
                        ADD_FAILURE() << builder.name << " " << accelerator.name << " ray " << i << ": primitive "
                                      << found.primitive << " at " << found.hit.t << ", brute force "
                                      << expected.closest[i].primitive << " at " << expected.closest[i].hit.t << "; "
                                      << text(expected.rays[i]);
                    }
                }
                EXPECT_EQ(wrong, 0u) << builder.name << " " << accelerator.name << " leaf size " << leaf_size;
                EXPECT_GT(counter.nodes_visited, 0u);
            }
        }
    }
}

// Whether some leaf with the primitive is reached when nodes whose boxes the ray does not enter by best_t are left out.
bool is_reached(const BinaryTree& tree, std::uint32_t at, std::uint32_t primitive, const BoxRay<float>& ray,
                float best_t) {
    const BinaryTree::Node& node = tree.nodes[at];
    const Vec3<float> low{node.box.low[0], node.box.low[1], node.box.low[2]};
    const Vec3<float> high{node.box.high[0], node.box.high[1], node.box.high[2]};
    const bool x = ray.is_reversed(0), y = ray.is_reversed(1), z = ray.is_reversed(2);
    if (ray.entry({x ? high.x : low.x, y ? high.y : low.y, z ? high.z : low.z},
                  {x ? low.x : high.x, y ? low.y : high.y, z ? low.z : high.z}, best_t) < 0) {
        return false;
    }
    if (!node.is_leaf()) {
        return is_reached(tree, node.first, primitive, ray, best_t) ||
               is_reached(tree, node.first + 1, primitive, ray, best_t);
    }
    const auto first = tree.references.begin() + node.first;
    return std::find(first, first + node.count, primitive) != first + node.count;
}

// What bitwise results rest on, without a traversal: all boxes over brute force's triangle are entered at or before it.
TEST_P(BitwiseTest, BruteForcesTriangleLiesBelowBoxesThatAreEntered) {
    const Triangles& triangles = GetParam().triangles;
    const Expected expected = by_brute_force(triangles, 4000);
    for (const BuilderChoice& builder : builders()) {
        const BinaryTree tree = builder.build(triangles, 1);
        const Box& root = tree.nodes[0].box;
        const BoxSpan spans[3] = {
            {root.low[0], root.high[0]}, {root.low[1], root.high[1]}, {root.low[2], root.high[2]}};
        for (std::size_t i = 0; i < expected.rays.size(); ++i) {
            const TestRay& ray = expected.rays[i];
            const ClosestHit& closest = expected.closest[i];
            if (closest.hit.hits) {
                const auto box_ray = BoxRay<float>::of(ray.origin, ray.direction, spans);
                ASSERT_TRUE(is_reached(tree, 0, closest.primitive, box_ray, closest.hit.t))
                    << builder.name << " " << i << " " << text(ray);
            }
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Scenes, BitwiseTest, testing::ValuesIn(triangle_scenes()),
                         [](const auto& scene) { return scene.param.name; });

TEST(AcceleratorTest, TreeOfNothingIsNeverEntered) {
    for (const BuilderChoice& builder : builders()) {
        const BinaryTree tree = builder.build({}, 4);
        EXPECT_TRUE(tree.nodes.empty()) << builder.name;
        for (const AcceleratorChoice& accelerator : accelerators()) {
            TraversalCounter counter;
            const EncodedTree encoded = accelerator.encode(tree);
            EXPECT_FALSE(accelerator.trace(encoded, {}, {{0, 0, 0}, {0, 0, 1}}, counter).hit.hits);
            EXPECT_EQ(counter.nodes_visited, 0u);
        }
    }
}

// No split helps, and every ray meets every leaf: the least primitive wins wherever it lies.
TEST(AcceleratorTest, EqualTrianglesLeaveTheFirst) {
    const Triangles triangles = equal_triangles(65536);
    const TestRay ray{{0.25f, 0.25f, -1}, {0, 0, 1}};
    const ClosestHit expected = brute_force(triangles, ray);
    ASSERT_EQ(expected.primitive, 0u);
    for (const BuilderChoice& builder : builders()) {
        const BinaryTree tree = builder.build(triangles, 4);
        for (const AcceleratorChoice& accelerator : accelerators()) {
            TraversalCounter counter;
            EXPECT_TRUE(accelerator.trace(accelerator.encode(tree), triangles, ray, counter) == expected)
                << builder.name << " " << accelerator.name;
            EXPECT_EQ(counter.primitives_tested, triangles.size()) << builder.name << " " << accelerator.name;
        }
    }
}

// A leaf at every level: the deepest tree that is allowed, and one level more.
BinaryTree chain(std::uint32_t depth, const Triangles& triangles) {
    BinaryTree tree;
    const Box box = boxes_of(triangles)[0];
    tree.nodes.push_back({box, 1, 0});
    for (std::uint32_t level = 1; level <= depth; ++level) {
        tree.nodes.push_back({box, level - 1, 1});
        tree.references.push_back(level - 1);
        tree.nodes.push_back({box, level == depth ? depth : 2 * level + 1, level == depth ? 1u : 0u});
    }
    tree.references.push_back(depth);
    return tree;
}

TEST(AcceleratorTest, DeepestTreeThatIsAllowedFitsTheStack) {
    const Triangles triangles = equal_triangles(66);
    const TestRay ray{{0.25f, 0.25f, -1}, {0, 0, 1}};
    for (const AcceleratorChoice& accelerator : accelerators()) {
        TraversalCounter counter;
        const EncodedTree encoded = accelerator.encode(chain(64, triangles));
        EXPECT_TRUE(accelerator.trace(encoded, triangles, ray, counter) == brute_force(triangles, ray));
        EXPECT_EQ(counter.primitives_tested, 65u) << accelerator.name;
        EXPECT_THROW(accelerator.encode(chain(65, triangles)), std::length_error) << accelerator.name;
    }
}

TEST(AcceleratorTest, NegativeBestEndsTheTraversal) {
    const Triangles triangles = equal_triangles(1000);
    const EncodedTree tree = accelerator::bvh2::encode(builders()[0].build(triangles, 1));
    float best = std::numeric_limits<float>::infinity();
    TraversalCounter counter;
    const auto leaf = [&](std::uint32_t, std::uint32_t) { best = -1; };
    accelerator::bvh2::traverse<float>(tree.view(), {0.25f, 0.25f, -1}, {0, 0, 1}, best, leaf, counter);
    EXPECT_EQ(counter.primitives_tested, 1u);
}

TEST(AcceleratorTest, LeavesThatLinksCannotHoldAreRefused) {
    const Triangles triangles = equal_triangles(17);
    const BinaryTree tree{{{boxes_of(triangles)[0], 0, 17}}, std::vector<std::uint32_t>(17, 0)};
    for (const AcceleratorChoice& accelerator : accelerators()) {
        EXPECT_THROW(accelerator.encode(tree), std::length_error) << accelerator.name;
    }
}

}  // namespace
}  // namespace pt::test
