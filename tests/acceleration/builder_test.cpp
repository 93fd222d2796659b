// What every builder leaves is a tree: complete, nested, no deeper than stacks allow, the same on any number of
// threads. And quality has the order that the literature gives.
#include <gtest/gtest.h>

#include <omp.h>

#include "tests/acceleration/builders.h"
#include "variants/builder/pairing.h"
#include "variants/builder/reinsertion.h"
#include "variants/builder/spatial_split.h"
#include "variants/bvh/box.h"
#include "variants/bvh/collapse.h"
#include "variants/bvh/depth.h"

namespace pt::test {
namespace {

bool operator==(const Box& a, const Box& b) { return contains(a, b) && contains(b, a); }

bool are_equal(const BinaryTree& a, const BinaryTree& b) {
    bool equal = a.references == b.references && a.nodes.size() == b.nodes.size();
    for (std::size_t i = 0; equal && i < a.nodes.size(); ++i) {
        equal = a.nodes[i].box == b.nodes[i].box && a.nodes[i].first == b.nodes[i].first &&
                a.nodes[i].count == b.nodes[i].count;
    }
    return equal;
}

class BuilderTest : public testing::TestWithParam<BuilderChoice> {
protected:
    static BinaryTree checked(const Triangles& triangles, std::uint32_t leaf_size) {
        BinaryTree tree = GetParam().build(triangles, leaf_size);
        EXPECT_NO_THROW(builder::check(tree, boxes_of(triangles), GetParam().is_whole));
        for (const BinaryTree::Node& node : tree.nodes) {
            EXPECT_LE(node.count, leaf_size);
        }
        return tree;
    }
};

TEST_P(BuilderTest, TreesAreWhole) {
    for (const TriangleScene& scene : triangle_scenes()) {
        SCOPED_TRACE(scene.name);
        for (const std::uint32_t leaf_size : {1u, 3u, 16u}) {
            checked(scene.triangles, leaf_size);
        }
    }
    checked({}, 1);
}

TEST_P(BuilderTest, DepthIsBoundedWhereNoSplitHelps) {
    const BinaryTree equal = checked(equal_triangles(65536), 1);
    EXPECT_LE(tree_depth(equal), max_tree_depth);
    if (GetParam().name != "lbvh") {  // which parts equal codes by the primitives' numbers: as deep, here
        EXPECT_EQ(tree_depth(equal), 16u);
    }
    checked(geometric_progression(3000), 1);
}

TEST_P(BuilderTest, AnyNumberOfThreadsLeavesTheSameTree) {
    Triangles triangles = random_soup(12000, 0.07f, 12);
    const Triangles sphere = grid_sphere(40, 60, {0, 0, 0}, 1);
    triangles.insert(triangles.end(), sphere.begin(), sphere.end());
    const int threads = omp_get_max_threads();
    omp_set_num_threads(1);
    const BinaryTree alone = checked(triangles, 2);
    for (const int number : {2, 3}) {
        omp_set_num_threads(number);
        EXPECT_TRUE(are_equal(alone, GetParam().build(triangles, 2))) << number;
    }
    omp_set_num_threads(threads);
}

INSTANTIATE_TEST_SUITE_P(Builders, BuilderTest, testing::ValuesIn(builders()),
                         [](const auto& builder) { return builder.param.name; });

double cost_of(const char* name, const Triangles& triangles) {
    for (const BuilderChoice& builder : builders()) {
        if (builder.name == name) {
            return builder::tree_cost(builder.build(triangles, 4));
        }
    }
    throw std::logic_error(name);
}

TEST(TreeQualityTest, SweepIsNoWorseThanBinsAndBothBetterThanMortonOrder) {
    const Triangles triangles = grid_sphere(60, 90, {0, 0, 0}, 1);
    EXPECT_LE(cost_of("sah_sweep", triangles), 1.02 * cost_of("sah_binned", triangles));
    EXPECT_LT(cost_of("sah_binned", triangles), cost_of("lbvh", triangles));
    EXPECT_LT(cost_of("ploc", triangles), cost_of("lbvh", triangles));
}

TEST(TreeQualityTest, ReinsertionBettersATree) {
    for (const Triangles& triangles : {grid_sphere(60, 90, {0, 0, 0}, 1), random_soup(3000, 0.05f, 3)}) {
        EXPECT_LT(cost_of("ploc_reinserted", triangles), 0.98 * cost_of("ploc", triangles));
    }
}

// Four unit cubes in a row, paired crosswise: one move and the fitting of boxes leave neighbours as siblings.
TEST(ReinsertionTest, PutsNeighboursSideBySide) {
    PrimitiveBoxes boxes(4);
    for (int i = 0; i < 4; ++i) {
        const float x = i < 2 ? static_cast<float>(i) : static_cast<float>(i + 98);
        boxes[i].low[0] = x;
        boxes[i].high[0] = x + 1;
        for (int axis : {1, 2}) {
            boxes[i].low[axis] = 0;
            boxes[i].high[axis] = 1;
        }
    }
    // Nodes 4 and 5 are (0, 2) and (1, 3), the root has them.
    builder::Pairing pairing{{0, 1, 2, 3}, {0, 1, 4}, {2, 3, 5}, 6};
    builder::reinsert(pairing, boxes, 4);
    const BinaryTree tree = builder::assemble(pairing, boxes, 1, {});
    builder::check(tree, boxes, true);
    // Half areas: 205 of the root, 5 of each pair, 3 of each cube.
    EXPECT_DOUBLE_EQ(builder::tree_cost(tree, {.traversal = 205, .intersection = 205}), 205 + 2 * 5 + 4 * 3);
}

TEST(TreeQualityTest, SpatialSplitsPayOnLongTriangles) {
    const Triangles triangles = sticks_in_soup(3000, 100, 5);
    EXPECT_LT(cost_of("sbvh", triangles), 0.5 * cost_of("sah_binned", triangles));
}

TEST(TreeQualityTest, DuplicatesStayWithinTheirBudget) {
    const Triangles triangles = sticks_in_soup(1000, 500, 5);
    const std::size_t count = triangles.size();
    const auto references = [&](double duplicates) {
        const BinaryTree tree = builder::sbvh::build(triangles, {.leaf_size = 1, .duplicates = duplicates});
        builder::check(tree, boxes_of(triangles), false);
        return tree.references.size();
    };
    EXPECT_EQ(references(0), count);
    EXPECT_GT(references(0.25), count);
    EXPECT_LE(references(0.25), count + count / 4);
    EXPECT_GT(references(2), references(0.25));
}

// Two unit cubes side by side in a box 3 x 1 x 1: half areas 3, 3 and 7.
TEST(TreeCostTest, IsTheSumOverNodesByArea) {
    const auto cube = [](float x) {
        Box box;
        box.low[0] = x;
        box.low[1] = box.low[2] = 0;
        box.high[0] = x + 1;
        box.high[1] = box.high[2] = 1;
        return box;
    };
    const BinaryTree tree{{{joined(cube(0), cube(2)), 1, 0}, {cube(0), 0, 1}, {cube(2), 1, 2}}, {0, 1, 2}};
    EXPECT_DOUBLE_EQ(builder::tree_cost(tree), 1.2 + 3.0 / 7 + 2 * 3.0 / 7);
    EXPECT_DOUBLE_EQ(builder::tree_cost(tree, {.traversal = 2, .intersection = 7}), 2 + 3.0 + 6.0);
    EXPECT_EQ(builder::tree_cost({}), 0);
}

// A chain, each inner node over one primitive and the rest: what merging the nearest makes of sizes that grow.
TEST(WithinDepthTest, ATreeThatIsTooDeepIsAssembledAnew) {
    const Triangles triangles = geometric_progression(120);
    const PrimitiveBoxes boxes = boxes_of(triangles);
    BinaryTree chain;
    chain.nodes.resize(2 * triangles.size() - 1);
    for (std::uint32_t i = 0; i < triangles.size(); ++i) {
        chain.references.push_back(i);
        const std::uint32_t slot = i + 1 < triangles.size() ? 2 * i + 1 : 2 * i;
        chain.nodes[slot] = {boxes[i], i, 1};
    }
    for (auto i = static_cast<std::uint32_t>(triangles.size()) - 1; i-- > 0;) {
        const std::uint32_t child = 2 * i + 1;
        chain.nodes[2 * i] = {joined(chain.nodes[child].box, chain.nodes[child + 1].box), child, 0};
    }
    ASSERT_EQ(tree_depth(chain), triangles.size() - 1);
    EXPECT_NO_THROW(builder::check(builder::within_depth(chain, boxes), boxes));
    const BinaryTree good = builder::sah_binned::build(boxes, 2);
    EXPECT_EQ(builder::within_depth(good, boxes).references, good.references);
}

TEST(CheckTest, FindsEachFault) {
    const Triangles triangles = random_soup(20, 0.2f, 3);
    const PrimitiveBoxes boxes = boxes_of(triangles);
    const BinaryTree good = builder::sah_binned::build(boxes, 2);
    ASSERT_NO_THROW(builder::check(good, boxes));
    const auto expect_fault = [&](const char* what, auto&& spoil) {
        BinaryTree tree = good;
        spoil(tree);
        EXPECT_THROW(builder::check(tree, boxes), std::logic_error) << what;
    };
    expect_fault("lost primitive", [](BinaryTree& tree) { tree.references[3] = tree.references[4]; });
    expect_fault("out of range", [](BinaryTree& tree) { tree.references[3] = 20; });
    expect_fault("no such child", [](BinaryTree& tree) { tree.nodes[0].first = 1000; });
    expect_fault("circle", [](BinaryTree& tree) { tree.nodes[1].first = 0, tree.nodes[1].count = 0; });
    expect_fault("box too small", [](BinaryTree& tree) { tree.nodes[0].box.high[1] -= 0.1f; });
    expect_fault("left over", [](BinaryTree& tree) { tree.nodes.push_back(tree.nodes.back()); });
    expect_fault("left over reference", [](BinaryTree& tree) { tree.references.push_back(0); });
    expect_fault("nothing", [](BinaryTree& tree) { tree = {}; });
}

TEST(CollapseTest, WideNodesHoldEachSubtreeOnce) {
    const Triangles triangles = random_soup(500, 0.1f, 8);
    const BinaryTree tree = builder::sah_binned::build(boxes_of(triangles), 2);
    for (const std::uint32_t width : {2u, 4u, 8u}) {
        const WideTree wide = collapse(tree, width, 1000);
        std::size_t leaves = 0, inner = 1;
        for (const WideTree::Node& node : wide.nodes) {
            EXPECT_GE(node.count, 2u);
            EXPECT_LE(node.count, width);
            for (std::uint32_t i = 0; i < node.count; ++i) {
                leaves += tree.nodes[node.child[i]].is_leaf() ? 1 : 0;
                inner += node.inner[i] != 0 ? 1 : 0;
            }
        }
        EXPECT_EQ(leaves, (tree.nodes.size() + 1) / 2);
        EXPECT_EQ(inner, wide.nodes.size());
    }
}

// Where area leads down a chain, the collapse by height keeps to the stack that it promises.
TEST(CollapseTest, TakesHighestSubtreesWhereTheStackIsShort) {
    const Triangles triangles = geometric_progression(3000);
    const BinaryTree tree = builder::sah_binned::build(boxes_of(triangles), 1);
    const std::uint32_t depth = tree_depth(tree);
    const std::uint32_t bound4 = 1 + 3 * ((depth + 1) / 2), bound8 = 1 + 7 * ((depth + 2) / 3);
    EXPECT_LE(stack_need(collapse(tree, 4, bound4), 4), bound4);
    EXPECT_LE(stack_need(collapse(tree, 8, bound8), 8), bound8);
    EXPECT_THROW(collapse(tree, 4, 3), std::length_error);
}

// Both parts of a triangle hold all of its points on their side, and nothing beyond the reference's box.
TEST(SpatialSplitTest, PartsHoldTheirSidesPoints) {
    const Triangles triangles = random_soup(200, 1, 77);
    for (std::uint32_t i = 0; i < triangles.size(); ++i) {
        const Triangle<float>& t = triangles[i];
        const Box box = box_of(t);
        const int axis = static_cast<int>(i % 3);
        const float plane = centre(box, axis);
        const auto [left, right] = builder::part(t, box, axis, plane);
        EXPECT_TRUE(contains(box, left) && contains(box, right));
        EXPECT_TRUE(joined(left, right) == box);
        for (int u = 0; u <= 16; ++u) {
            for (int v = 0; v <= 16 - u; ++v) {
                const Vec3<double> a(t.a), b(t.b), c(t.c),
                    point = (a * double(16 - u - v) + b * double(u) + c * double(v)) / 16.0;
                const Box& side = point[axis] <= plane ? left : right;
                for (int k = 0; k < 3; ++k) {
                    EXPECT_LE(side.low[k], point[k]) << i;
                    EXPECT_GE(side.high[k], point[k]) << i;
                }
            }
        }
    }
}

}  // namespace
}  // namespace pt::test
