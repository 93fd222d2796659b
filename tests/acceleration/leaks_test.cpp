// No ray from within a closed mesh at its vertices and edges gets out, through any accelerator; and the count of those
// that do is not 0 where the triangles' test or the boxes leave a gap.
#include <gtest/gtest.h>

#include <cmath>

#include "harness/rays/leak_rays.h"
#include "tests/acceleration/builders.h"
#include "tests/acceleration/closest.h"
#include "variants/accelerator/bvh2.h"
#include "variants/accelerator/bvh4.h"
#include "variants/accelerator/bvh8.h"
#include "variants/accelerator/cwbvh.h"

namespace pt::test {
namespace {

using rays::count_leaks;
using rays::LeakCounts;
using rays::LeakSource;
using Misses = std::function<bool(const rays::Ray&)>;

constexpr std::uint64_t many = 1000000, few = 50000;

TestRay as_test_ray(const rays::Ray& ray) {
    return {{ray.origin[0], ray.origin[1], ray.origin[2]}, {ray.direction[0], ray.direction[1], ray.direction[2]}};
}

// A sphere of 9024 triangles whose poles are fans of 96, with a cube well inside.
LeakSource sphere_at(const Vec3<float>& centre) {
    return {moved(grid_sphere(48, 96, {0, 0, 0}, 1), centre), {{{centre.x, centre.y, centre.z}, 0.5f}}, 7};
}

// The walls of all cubes of a sponge; from the one at the origin no ray gets out.
LeakSource sponge() { return {menger(2), {{{0.5f, 0.5f, 0.5f}, 0.45f}}, 7}; }

template <class Encode, class Traverse>
Misses through_tree(const LeakSource& source, const BinaryTree& tree, Encode encode, Traverse traverse) {
    auto encoded = std::make_shared<EncodedTree>(encode(tree));
    return [&source, encoded, traverse](const rays::Ray& ray) {
        TraversalCounter counter;
        return !through(*encoded, source.triangles, as_test_ray(ray), traverse, counter).hit.hits;
    };
}

std::map<std::string, Misses> through_all(const LeakSource& source, const BinaryTree& tree) {
    return {{"bvh2", through_tree(source, tree, &accelerator::bvh2::encode,
                                  [](auto&&... all) { accelerator::bvh2::traverse<float>(all...); })},
            {"bvh4", through_tree(source, tree, &accelerator::bvh4::encode,
                                  [](auto&&... all) { accelerator::bvh4::traverse<float>(all...); })},
            {"bvh8", through_tree(source, tree, &accelerator::bvh8::encode,
                                  [](auto&&... all) { accelerator::bvh8::traverse<float>(all...); })},
            {"cwbvh", through_tree(source, tree, &accelerator::cwbvh::encode,
                                   [](auto&&... all) { accelerator::cwbvh::traverse<float>(all...); })}};
}

BinaryTree tree_of(const LeakSource& source) { return builders()[0].build(source.triangles, 2); }

void expect_none(const LeakSource& source, std::uint64_t count) {
    for (const auto& [name, misses] : through_all(source, tree_of(source))) {
        const LeakCounts counts = count_leaks(source.view(), 0, count, misses);
        for (std::uint32_t kind = 0; kind < rays::leak_class_count; ++kind) {
            EXPECT_EQ(counts.leaks[kind], 0u) << name << " " << rays::leak_classes[kind];
            EXPECT_GE(counts.rays[kind], count / rays::leak_class_count) << name;
        }
    }
}

TEST(LeaksTest, NoneOfAMillionLeavesASphere) { expect_none(sphere_at({0, 0, 0}), many); }
TEST(LeaksTest, NoneLeavesASphereFarAway) { expect_none(sphere_at({148376, 1234, -223423}), few); }
TEST(LeaksTest, NoneLeavesACubeOfASponge) { expect_none(sponge(), few); }

TEST(LeaksTest, BruteForceLetsNoneOut) {
    const LeakSource source = sphere_at({0, 0, 0});
    const auto misses = [&](const rays::Ray& ray) { return !brute_force(source.triangles, as_test_ray(ray)).hit.hits; };
    EXPECT_EQ(count_leaks(source.view(), 0, 2000, misses).all_leaks(), 0u);
}

// The rule for edges dropped: a weight of 0 is outside of both triangles that share the edge.
TEST(LeaksTest, TrianglesWithoutTheirEdgesLeak) {
    const LeakSource source = sphere_at({0, 0, 0});
    const auto misses = [&](const rays::Ray& ray) {
        const TestRay test = as_test_ray(ray);
        const auto sheared = ShearedDirection<float>::of(test.direction);
        for (const Triangle<float>& triangle : source.triangles) {
            const TriangleHit<float> hit = intersect(triangle, test.origin, sheared);
            if (hit.hits && hit.u != 0 && hit.v != 0 && hit.w != 0) {
                return false;
            }
        }
        return true;
    };
    const LeakCounts counts = count_leaks(source.view(), 0, 7 * 300, misses);
    EXPECT_GT(counts.leaks[0], 0u);  // vertices
    EXPECT_GT(counts.all_leaks(), counts.leaks[0]);
}

// Boxes 2^-18 of their place too small; a few units in the last place are within the slack of the boxes' test.
TEST(LeaksTest, BoxesTooSmallLeak) {
    const LeakSource source = sponge();
    BinaryTree tree = tree_of(source);
    for (BinaryTree::Node& node : tree.nodes) {
        for (int axis = 0; axis < 3; ++axis) {
            node.box.low[axis] += std::fabs(node.box.low[axis]) * 0x1p-18f;
            node.box.high[axis] -= std::fabs(node.box.high[axis]) * 0x1p-18f;
        }
    }
    EXPECT_GT(count_leaks(source.view(), 0, few, through_all(source, tree)["bvh2"]).all_leaks(), 0u);
}

TEST(LeaksTest, AMeshWithAHoleLeaks) {
    const LeakSource source = sphere_at({0, 0, 0});
    LeakSource open = source;
    open.triangles.erase(open.triangles.begin(), open.triangles.begin() + 40);
    // Aimed at the closed one's edges, traced through what is left of it.
    const Misses misses = through_all(open, tree_of(open))["cwbvh"];
    EXPECT_GT(count_leaks(source.view(), 0, few, misses).all_leaks(), 0u);
}

// A ray is said by its number and the seed alone.
TEST(LeaksTest, RaysDependOnNumberAndSeedAlone) {
    LeakSource source = sphere_at({0, 0, 0});
    const rays::Ray ray = rays::leak_ray(source.view(), 123456789012345ull);
    const rays::Ray same = rays::leak_ray(source.view(), 123456789012345ull);
    EXPECT_EQ(std::memcmp(&ray, &same, sizeof ray), 0);
    source.seed = 8;
    const rays::Ray other = rays::leak_ray(source.view(), 123456789012345ull);
    EXPECT_NE(std::memcmp(&ray, &other, sizeof ray), 0);
}

}  // namespace
}  // namespace pt::test
