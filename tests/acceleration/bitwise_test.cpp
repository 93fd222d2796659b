// Every builder x accelerator leaves brute force's closest hit, bit for bit.
#include <gtest/gtest.h>

#include <functional>
#include <sstream>

#include "tests/acceleration/closest.h"
#include "tests/acceleration/triangle_scenes.h"
#include "variants/acceleration/box.h"
#include "variants/acceleration/box_ray.h"
#include "variants/acceleration/primitive_boxes.h"
#include "variants/accelerator/bvh2.h"
#include "variants/accelerator/bvh4.h"
#include "variants/accelerator/bvh8.h"
#include "variants/builder/lbvh.h"
#include "variants/builder/ploc.h"
#include "variants/builder/sah_binned.h"
#include "variants/builder/sah_sweep.h"

namespace pt::test {
namespace {

using Build = std::function<BinaryTree(const Triangles&, std::uint32_t)>;
using Trace = std::function<ClosestHit(const EncodedTree&, const Triangles&, const TestRay&, TraversalCounter&)>;

struct BuilderChoice {
    std::string name;
    Build build;
    bool is_whole;  // no primitive is parted over leaves
};

struct AcceleratorChoice {
    std::string name;
    EncodedTree (*encode)(const BinaryTree&);
    Trace trace;
};

PrimitiveBoxes boxes_of(const Triangles& triangles) {
    return primitive_boxes(std::span<const Triangle<float>>(triangles));
}

using BuildOfBoxes = BinaryTree (*)(const PrimitiveBoxes&, std::uint32_t);

BuilderChoice of_boxes(const std::string& name, BuildOfBoxes build) {
    return {
        name,
        [build](const Triangles& triangles, std::uint32_t leaf_size) { return build(boxes_of(triangles), leaf_size); },
        true};
}

std::vector<BuilderChoice> builders() {
    return {of_boxes("sah_binned", [](const PrimitiveBoxes& boxes,
                                      std::uint32_t size) { return builder::sah_binned::build(boxes, size); }),
            of_boxes("sah_sweep", [](const PrimitiveBoxes& boxes,
                                     std::uint32_t size) { return builder::sah_sweep::build(boxes, size); }),
            of_boxes("lbvh",
                     [](const PrimitiveBoxes& boxes, std::uint32_t size) { return builder::lbvh::build(boxes, size); }),
            of_boxes("ploc", [](const PrimitiveBoxes& boxes, std::uint32_t size) {
                return builder::ploc::build(boxes, size);
            })};
}

std::vector<AcceleratorChoice> accelerators() {
    // NOLINTNEXTLINE(cppcoreguidelines-macro-usage)
#define ACCELERATOR(NAME)                                                                               \
    {                                                                                                   \
#NAME, [](const BinaryTree& tree) { return accelerator::NAME::encode(tree); },                        \
            [](const EncodedTree& tree, const Triangles& triangles, const TestRay& ray, TraversalCounter& counter) { \
                return through(                                                                               \
                    tree, triangles, ray, [](auto&&... all) { accelerator::NAME::traverse<float>(all...); },  \
                    counter);                                                                                 \
            } \
    }
    return {ACCELERATOR(bvh2), ACCELERATOR(bvh4), ACCELERATOR(bvh8)};
#undef ACCELERATOR
}

std::string text(const TestRay& ray) {
    std::ostringstream out;
    out << std::hexfloat << "ray " << ray.origin.x << " " << ray.origin.y << " " << ray.origin.z << " -> "
        << ray.direction.x << " " << ray.direction.y << " " << ray.direction.z;
    return out.str();
}

class BitwiseTest : public testing::TestWithParam<TriangleScene> {};

TEST_P(BitwiseTest, EveryBuilderAndAcceleratorLeavesBruteForcesHit) {
    const Triangles& triangles = GetParam().triangles;
    const std::vector<TestRay> rays = rays_for(triangles, 12000, 99);
    std::vector<ClosestHit> expected(rays.size());
    std::size_t hits = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        expected[i] = brute_force(triangles, rays[i]);
        hits += expected[i].hit.hits ? 1 : 0;
    }
    EXPECT_GT(hits, rays.size() / 50);
    for (const BuilderChoice& builder : builders()) {
        for (const std::uint32_t leaf_size : {1u, 4u}) {
            const BinaryTree tree = builder.build(triangles, leaf_size);
            ASSERT_NO_THROW(builder::check(tree, boxes_of(triangles), builder.is_whole)) << builder.name;
            for (const AcceleratorChoice& accelerator : accelerators()) {
                const EncodedTree encoded = accelerator.encode(tree);
                TraversalCounter counter;
                std::size_t wrong = 0;
                for (std::size_t i = 0; i < rays.size(); ++i) {
                    const ClosestHit found = accelerator.trace(encoded, triangles, rays[i], counter);
                    if (!(found == expected[i]) && wrong++ < 3) {
                        ADD_FAILURE() << builder.name << " " << accelerator.name << " ray " << i << ": primitive "
                                      << found.primitive << " at " << found.hit.t << ", brute force "
                                      << expected[i].primitive << " at " << expected[i].hit.t << "; " << text(rays[i]);
                    }
                }
                EXPECT_EQ(wrong, 0u) << builder.name << " " << accelerator.name << " leaf size " << leaf_size;
                EXPECT_GT(counter.nodes_visited, 0u);
            }
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Scenes, BitwiseTest, testing::ValuesIn(triangle_scenes()),
                         [](const auto& scene) { return scene.param.name; });

}  // namespace
}  // namespace pt::test
