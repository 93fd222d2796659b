// None of 10^9 rays that leave a body meets it again, none of 10^9 that run through one stays in it, and none of 10^9
// through a box's edges misses the box: numerics of S15 and S21, with the device's arithmetic. Skipped where there is
// no GPU. Writes what it counted to standard output.
#include <cstdio>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "harness/cuda/backend.h"
#include "harness/scene/scene_buffers.h"
#include "tests/gpu/segments.h"
#include "tests/support/scenes.h"

namespace pt::test {
namespace {

constexpr std::uint32_t rounds = 2048;  // 2^29 rays a place

struct Place {
    double radius, distance;  // scene units; radii from the eye
};
constexpr Place places[] = {{1e-6, 1}, {1e-3, 1}, {1, 1}, {1e3, 1}, {1e6, 1}, {1, 1e2}, {1, 1e4}};

class SegmentsTest : public testing::Test {
protected:
    void SetUp() override {
        if (const std::string reason = cuda::not_available(); !reason.empty()) {
            GTEST_SKIP() << reason;
        }
    }

    // add_body(builder, material, centre, scale): one object.
    template <class AddBody>
    void expect_no_self_hits(const char* shape, const AddBody& add_body) {
        StartedSegments all;
        for (const Place& place : places) {
            const Vec3d centre = Vec3d(2, 3, 6) * (place.distance * place.radius / 7);
            SceneBuilder builder;
            add_body(builder, builder.diffuse(Vec3d(0.5)), centre, place.radius);
            const SceneBuffers<float> buffers(builder.scene, default_settings(builder.scene));
            const StartedSegments found =
                start_segments(buffers.view(), Vec3<float>(centre), static_cast<float>(place.radius), rounds);
            EXPECT_EQ(found.self_hits, 0u) << shape << " of radius " << place.radius << " at " << place.distance;
            EXPECT_EQ(found.leaks, 0u) << shape << " of radius " << place.radius << " at " << place.distance;
            all.outward += found.outward;
            all.self_hits += found.self_hits;
            all.inward += found.inward;
            all.leaks += found.leaks;
        }
        EXPECT_GT(all.outward, 1000000000u);
        fmt::print("{}: {} segments outward, {} self-hits; {} inward, {} leaks\n", shape, all.outward, all.self_hits,
                   all.inward, all.leaks);
    }
};

constexpr Vec3d turn(10, 20, 30);
Vec3d scale(double radius) { return Vec3d(2, 3, 1.5) * radius; }

TEST_F(SegmentsTest, OffASphere) {
    expect_no_self_hits("sphere", [](SceneBuilder& builder, std::uint32_t material, const Vec3d& centre, double r) {
        builder.sphere(material, centre, 2 * r);
    });
}

TEST_F(SegmentsTest, OffAnEllipsoid) {
    expect_no_self_hits("ellipsoid", [](SceneBuilder& builder, std::uint32_t material, const Vec3d& centre, double r) {
        builder.ellipsoid(material, centre, scale(r), turn);
    });
}

TEST_F(SegmentsTest, OffAnAxisBox) {
    expect_no_self_hits("axis box", [](SceneBuilder& builder, std::uint32_t material, const Vec3d& centre, double r) {
        builder.box(material, centre, scale(r));
    });
}

TEST_F(SegmentsTest, OffAnOrientedBox) {
    expect_no_self_hits("oriented box", [](SceneBuilder& builder, std::uint32_t material, const Vec3d& centre,
                                           double r) { builder.box(material, centre, scale(r), turn); });
}

TEST_F(SegmentsTest, OffAQuad) {
    expect_no_self_hits("quad", [](SceneBuilder& builder, std::uint32_t material, const Vec3d& centre, double r) {
        builder.quad(material, centre, scale(r).x, scale(r).z, turn);
    });
}

TEST_F(SegmentsTest, ThroughABoxsEdges) {
    for (const float half_height : {2.0f, 0.25f, 1e-18f}) {
        const EdgeMisses found = cross_edges({0.5f, 1.0f, half_height}, 2 * rounds);
        EXPECT_GT(found.rays, 1000000000u);
        EXPECT_EQ(found.axis_box, 0u) << half_height;
        EXPECT_EQ(found.oriented_box, 0u) << half_height;
        fmt::print("box of half height {}: {} rays through its edges, {} miss it, {} miss it as an oriented box\n",
                   half_height, found.rays, found.axis_box, found.oriented_box);
    }
}

}  // namespace
}  // namespace pt::test
