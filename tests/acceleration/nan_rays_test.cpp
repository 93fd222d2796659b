// Rays with a NaN enter every box, that of a child that is not there too: they must come to an end, and meet nothing.
#include <gtest/gtest.h>

#include "tests/acceleration/builders.h"
#include "tests/acceleration/closest.h"
#include "tests/acceleration/triangle_scenes.h"
#include "variants/accelerator/bvh2.h"
#include "variants/accelerator/bvh4.h"
#include "variants/accelerator/bvh8.h"
#include "variants/accelerator/cwbvh.h"
#include "variants/bvh/collapse.h"
#include "variants/bvh/stacks.h"
#include "variants/registry.h"
#include "variants/traversal/if_if.cuh"
#include "variants/traversal/while_while.cuh"
#include "variants/traversal_stack/local.cuh"

namespace pt::test {
namespace {

constexpr std::uint32_t few[] = {1, 2, 3, 5, 7, 30};

// Each of the six numbers a NaN, 0, an infinity or another, and at least one of them a NaN.
std::vector<TestRay> rays_with_a_nan() {
    constexpr float infinity = std::numeric_limits<float>::infinity();
    constexpr float values[] = {std::numeric_limits<float>::quiet_NaN(), 0.0f, infinity, 0.7f};
    std::vector<TestRay> rays;
    for (std::uint32_t code = 0; code < 1u << 12; ++code) {
        float number[6];
        bool has_nan = false;
        for (std::uint32_t i = 0; i < 6; ++i) {
            number[i] = values[code >> 2 * i & 3u];
            has_nan = has_nan || number[i] != number[i];
        }
        if (has_nan) {
            rays.push_back({{number[0], number[1], number[2]}, {number[3], number[4], number[5]}});
        }
    }
    return rays;
}

template <class Open, std::uint32_t most>
using Local = traversal_stack::local::Stack<Open, most>;
template <class Open, std::uint32_t>
using Short = typename ShortStackFor<Open, LocalMemory<Open, 1>, 1>::Type;

template <class Traversal>
void expect_nothing_met(const EncodedTree& tree, const Triangles& triangles) {
    TraversalCounter counter;
    for (const TestRay& ray : rays_with_a_nan()) {
        EXPECT_EQ(through(
                      tree, triangles, ray, [](auto&&... all) { Traversal::template traverse<float>(all...); }, counter)
                      .primitive,
                  ~0u);
    }
}

template <class Accelerator>
void expect_an_end(EncodedTree (*encode)(const BinaryTree&)) {
    for (const std::uint32_t count : few) {
        const Triangles triangles = random_soup(count, 0.5f, count);
        const EncodedTree tree = encode(builder::sah_binned::build(boxes_of(triangles), 1));
        expect_nothing_met<Accelerator>(tree, triangles);
        expect_nothing_met<traversal::while_while::Traversal<Accelerator, Local>>(tree, triangles);
        expect_nothing_met<traversal::if_if::Traversal<Accelerator, Local>>(tree, triangles);
        expect_nothing_met<traversal::while_while::Traversal<Accelerator, Short>>(tree, triangles);
    }
}

TEST(NanRaysTest, ComeToAnEndInBvh2) { expect_an_end<accelerator::bvh2::Traversal>(accelerator::bvh2::encode); }
TEST(NanRaysTest, ComeToAnEndInBvh4) { expect_an_end<accelerator::bvh4::Traversal>(accelerator::bvh4::encode); }
TEST(NanRaysTest, ComeToAnEndInBvh8) { expect_an_end<accelerator::bvh8::Traversal>(accelerator::bvh8::encode); }
TEST(NanRaysTest, ComeToAnEndInCwbvh) { expect_an_end<accelerator::cwbvh::Traversal>(accelerator::cwbvh::encode); }

// Expects that rays of NaNs meet nothing, called as renders on the host call it: bvh4 and bvh8 have nodes and leaves of
// their own there.
void expect_nothing_met_by(const AcceleratorHook& hook, const Triangles& triangles) {
    const EncodedTree tree = hook.encode(builder::sah_binned::build(boxes_of(triangles), 1));
    std::vector<LeafTriangle> leaves;
    for (const std::uint32_t primitive : tree.references) {
        leaves.push_back(LeafTriangle::of(triangles[primitive], primitive));
    }
    const NativeMesh native = hook.prepare != nullptr ? hook.prepare(tree, leaves) : NativeMesh{};
    MeshInstance<float> mesh{};
    mesh.geometry.leaves = leaves.data();
    mesh.geometry.triangles = triangles.data();
    mesh.geometry.tree = tree.view();
    mesh.geometry.native = native.data.get();
    mesh.geometry.triangle_count = static_cast<std::uint32_t>(triangles.size());
    mesh.is_placed = 1;
    for (const TestRay& ray : rays_with_a_nan()) {
        Hit<float> best;
        hook.meet_single(best, mesh, 0, ray.origin, {ray.origin, ray.direction, 0.0f, SurfaceId(), 0}, 0);
        EXPECT_FALSE(best.side.exists());
    }
}

TEST(NanRaysTest, ComeToAnEndInRendersOnTheHost) {
    for (const char* name : {"bvh2", "bvh4", "bvh8", "cwbvh"}) {
        SCOPED_TRACE(name);
        for (const std::uint32_t count : few) {
            expect_nothing_met_by(Registry::instance().find("accelerator", name)->hook.accelerator,
                                  random_soup(count, 0.5f, count));
        }
    }
}

// What is not there waits on the stack as well.
TEST(NanRaysTest, TheStackHasPlaceForEveryChild) {
    const Triangles triangles = random_soup(2, 0.5f, 1);
    const BinaryTree tree = builder::sah_binned::build(boxes_of(triangles), 1);
    for (const std::uint32_t width : {4u, 8u}) {
        EXPECT_EQ(stack_need(collapse(tree, width, 100), width), width);
    }
}

}  // namespace
}  // namespace pt::test
