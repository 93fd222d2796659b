// The accelerators of the host that bring a form of their own (AcceleratorHook::prepare), as kernels call them: those
// that claim bits leave brute force's hit, Embree's own test almost always the same one.
#include <cmath>

#include <gtest/gtest.h>

#include "tests/acceleration/builders.h"
#include "variants/accelerator/cwbvh.h"
#include "variants/cpu/lanes.h"
#include "variants/registry.h"

namespace pt::test {
namespace {

// One mesh under one accelerator.
class Planted {
public:
    Planted(const Triangles& triangles, const AcceleratorHook& hook) : hook_(hook) {
        if (hook.encode != nullptr) {
            tree_ = hook.encode(builders()[0].build(triangles, 4));
            for (const std::uint32_t primitive : tree_.references) {
                leaves_.push_back(LeafTriangle::of(triangles[primitive], primitive));
            }
        } else {
            for (std::uint32_t i = 0; i < triangles.size(); ++i) {
                leaves_.push_back(LeafTriangle::of(triangles[i], i));
            }
        }
        if (hook.prepare != nullptr) {
            native_ = hook.prepare(tree_, leaves_);
        }
        mesh_.geometry.leaves = leaves_.data();
        mesh_.geometry.tree = tree_.view();
        mesh_.geometry.tree.slot_count = static_cast<std::uint32_t>(leaves_.size());
        mesh_.geometry.native = native_.data.get();
        mesh_.is_placed = 1;
    }
    Planted(const Planted&) = delete;
    Planted& operator=(const Planted&) = delete;

    const MeshInstance<float>& mesh() const { return mesh_; }
    bool has_lanes() const { return native_.data != nullptr && native_.data->meet_in_lanes != nullptr; }
    // What nearer_than leaves in each of the lanes that ask, where a limit and an end are given for every lane.
    lanes::Hits<float> nearer_in_lanes(const lanes::Paths<float>& rays, const lanes::Flags& asks,
                                       const lanes::Lanes<float>& limit, const lanes::Lanes<float>& enough) const {
        lanes::Hits<float> hits{};
        for (std::uint32_t l = 0; l < lanes::width; ++l) {
            hits.set(l, Hit<float>{limit[l], SurfaceId{}, 0});
        }
        native_.data->meet_in_lanes(hits, asks, mesh_, 7, rays.origin, rays, enough);
        return hits;
    }
    // The mesh in a space of its own: turned, and moved away.
    void place_elsewhere() {
        mesh_.is_placed = 0;
        mesh_.row[0] = {0.0f, 0.5f, 0.0f};
        mesh_.row[1] = {-0.5f, 0.0f, 0.0f};
        mesh_.row[2] = {0.0f, 0.0f, 0.5f};
        mesh_.offset = {0.25f, -0.125f, 0.5f};
    }
    Hit<float> closest(const Ray<float>& ray) const {
        return nearer_than(ray, std::numeric_limits<float>::infinity(), 0);
    }
    // Up to `limit`, ended by what is met before `enough`.
    Hit<float> nearer_than(const Ray<float>& ray, float limit, float enough) const {
        Hit<float> best;
        best.t = limit;
        hook_.meet_single(best, mesh_, 7, ray.origin, ray, enough);
        return best;
    }

private:
    AcceleratorHook hook_;
    EncodedTree tree_;
    std::vector<LeafTriangle> leaves_;
    NativeMesh native_;
    MeshInstance<float> mesh_{};
};

Ray<float> ray_of(const TestRay& ray) {
    Ray<float> all{};
    all.origin = ray.origin;
    all.direction = ray.direction;
    return all;
}

bool same_place(const Hit<float>& a, const Hit<float>& b) {
    return !a.side.exists() ? !b.side.exists()
                            : b.side.exists() && a.side.object() == b.side.object() &&
                                  a.side.inside() == b.side.inside() && a.primitive == b.primitive;
}
bool same_hit(const Hit<float>& a, const Hit<float>& b) { return a.t == b.t && same_place(a, b); }

const AcceleratorHook& hook_of(const char* name) {
    return Registry::instance().find("accelerator", name)->hook.accelerator;
}

class NativeTest : public testing::TestWithParam<const char*> {
protected:
    void SetUp() override {
        if (Registry::instance().find("accelerator", GetParam()) == nullptr) {
            GTEST_SKIP() << "this build has no accelerator=" << GetParam();
        }
    }
};

// Once from anywhere, and once more on from what was met: the triangle that a ray starts on is not met.
TEST_P(NativeTest, LeavesBruteForcesHit) {
    for (const TriangleScene& scene : triangle_scenes()) {
        const Planted expected(scene.triangles, hook_of("brute_force")), planted(scene.triangles, hook_of(GetParam()));
        std::size_t wrong = 0, hits = 0;
        for (const TestRay& test_ray : rays_for(scene.triangles, 4000, 5)) {
            Ray<float> ray = ray_of(test_ray);
            for (int turn = 0; turn < 2; ++turn) {
                const Hit<float> wanted = expected.closest(ray), found = planted.closest(ray);
                if (!same_hit(wanted, found) && wrong++ < 2) {
                    ADD_FAILURE() << scene.name << " turn " << turn << ": primitive " << found.primitive << " at "
                                  << found.t << ", brute force " << wanted.primitive << " at " << wanted.t;
                }
                if (!wanted.side.exists()) {
                    break;
                }
                ++hits;
                ray.origin_surface = wanted.side;
                ray.primitive = wanted.primitive;
            }
        }
        EXPECT_EQ(wrong, 0u) << scene.name;
        EXPECT_GT(hits, 50u) << scene.name;
    }
}

// Rays whose rounding is larger than any triangle's box.
TEST_P(NativeTest, LeavesBruteForcesHitFromAfar) {
    const Triangles triangles = grid_sphere(12, 16, {0, 0, 0}, 1);
    const Planted expected(triangles, hook_of("brute_force")), planted(triangles, hook_of(GetParam()));
    for (const float distance : {1e1f, 1e2f, 1e3f, 1e5f, 1e7f}) {
        std::size_t hits = 0;
        for (TestRay ray : rays_for(triangles, 2000, 6)) {
            const Vec3<float> d = ray.direction / std::sqrt(dot(ray.direction, ray.direction));
            ray.origin = ray.origin - d * distance;
            const Hit<float> wanted = expected.closest(ray_of(ray)), found = planted.closest(ray_of(ray));
            ASSERT_TRUE(same_hit(wanted, found)) << distance;
            hits += wanted.side.exists() ? 1 : 0;
        }
        EXPECT_GT(hits, 20u) << distance;
    }
}

// A shadow ray: ended by any hit before a distance, and otherwise the closest hit bit for bit.
void expect_an_end_before_a_distance(const Triangles& triangles, const AcceleratorHook& hook) {
    const Planted planted(triangles, hook);
    std::size_t ended = 0, others = 0;
    for (const TestRay& test_ray : rays_for(triangles, 4000, 7)) {
        const Ray<float> ray = ray_of(test_ray);
        const Hit<float> closest = planted.closest(ray);
        const float t = closest.side.exists() ? closest.t : 1.0f;
        for (const float enough : {0.5f * t, t, std::nextafter(t, 2 * t + 1), 2 * t, 1e30f}) {
            const Hit<float> found = planted.nearer_than(ray, 4 * enough, enough);
            if (closest.side.exists() && closest.t < enough) {
                ASSERT_EQ(found.t, -1.0f);
                ASSERT_TRUE(found.side.exists());
                ++ended;
            } else {
                ASSERT_TRUE(closest.side.exists() && closest.t < 4 * enough ? same_hit(found, closest)
                                                                            : !found.side.exists());
                ++others;
            }
        }
    }
    EXPECT_GT(ended, 200u);
    EXPECT_GT(others, 200u);
}

TEST_P(NativeTest, AnyHitBeforeADistanceEndsTheSearch) {
    expect_an_end_before_a_distance(random_soup(2000, 0.2f, 4), hook_of(GetParam()));
}

TEST(ShadowRaysTest, AnyHitBeforeADistanceEndsTheSearch) {
    for (const char* name : {"brute_force", "bvh2", "cwbvh"}) {
        SCOPED_TRACE(name);
        expect_an_end_before_a_distance(random_soup(500, 0.2f, 4), hook_of(name));
    }
}

// What it is for: rays that are blocked visit fewer nodes and triangles than the search for the closest hit.
TEST(ShadowRaysTest, ABlockedRayVisitsLess) {
    const Triangles triangles = random_soup(4000, 0.2f, 4);
    const Planted planted(triangles, hook_of("cwbvh"));
    const MeshInstance<float>& mesh = planted.mesh();
    std::uint64_t nodes_for_closest = 0, nodes_for_any = 0, primitives_for_closest = 0, primitives_for_any = 0;
    std::size_t blocked = 0;
    for (const TestRay& test_ray : rays_for(triangles, 4000, 7)) {
        const Ray<float> ray = ray_of(test_ray);
        Hit<float> closest, any;
        closest.t = any.t = 4.0f;
        TraversalCounter one, other;
        closest_in_mesh<accelerator::cwbvh::Traversal>(closest, mesh, 0, ray.origin, ray, one, WithClosest{});
        closest_in_mesh<accelerator::cwbvh::Traversal>(any, mesh, 0, ray.origin, ray, other, NearerThan<float>{4.0f});
        ASSERT_EQ(any.side.exists(), closest.side.exists());
        ASSERT_LE(other.nodes_visited, one.nodes_visited);
        if (closest.side.exists()) {
            ++blocked;
            nodes_for_closest += one.nodes_visited;
            nodes_for_any += other.nodes_visited;
            primitives_for_closest += one.primitives_tested;
            primitives_for_any += other.primitives_tested;
        }
    }
    EXPECT_GT(blocked, 1000u);
    EXPECT_LT(10 * nodes_for_any, 9 * nodes_for_closest);
    EXPECT_LT(10 * primitives_for_any, 9 * primitives_for_closest);
}

TEST_P(NativeTest, ATieGoesToTheFirstPrimitive) {
    const Planted planted(equal_triangles(1000), hook_of(GetParam()));
    Ray<float> ray = ray_of({{0.25f, 0.25f, -1}, {0, 0, 1}});
    const Hit<float> first = planted.closest(ray);
    EXPECT_EQ(first.primitive, 0u);
    ray.origin_surface = first.side;
    EXPECT_EQ(planted.closest(ray).primitive, 1u);
}

TEST_P(NativeTest, AMeshOfNothingIsNotMet) {
    EXPECT_FALSE(Planted({}, hook_of(GetParam())).closest(ray_of({{0, 0, 0}, {0, 0, 1}})).side.exists());
}

// Takes rays for a scene through both forms of the search, one by one and a packet at a time, and holds the second to
// the first in every bit. Some lanes do not ask, some start on a triangle, and some are ended before a distance.
class LanesBesideRays {
public:
    explicit LanesBesideRays(const Planted& planted) : planted_(planted) {}

    void take(const std::vector<TestRay>& test_rays) {
        const float infinity = std::numeric_limits<float>::infinity();
        for (std::size_t first = 0; first + lanes::width <= test_rays.size(); first += lanes::width) {
            for (std::uint32_t l = 0; l < lanes::width; ++l) {
                Path<float> path{};
                path.origin = test_rays[first + l].origin;
                path.direction = test_rays[first + l].direction;
                const Hit<float> before = planted_.closest(ray_of(path));
                const bool starts_there = before.side.exists() && l % 3 == 0;
                path.origin_surface = starts_there ? before.side : SurfaceId{};
                path.primitive = starts_there ? before.primitive : 0;
                rays_.store(l, path);
                asks_[l] = (first / lanes::width + l) % 5 == 0 ? 0u : 1u;
                enough_[l] = l % 4 == 0 ? before.t * (l % 8 == 0 ? 0.5f : 2.0f) : 0.0f;
                limit_[l] = l % 4 == 0 ? 4 * enough_[l] : infinity;
            }
            compare();
        }
    }
    std::size_t met = 0, ended = 0;

private:
    void compare() {
        const lanes::Hits<float> hits = planted_.nearer_in_lanes(rays_, asks_, limit_, enough_);
        for (std::uint32_t l = 0; l < lanes::width; ++l) {
            const Hit<float> wanted = asks_[l] != 0 ? planted_.nearer_than(rays_.ray(l), limit_[l], enough_[l])
                                                    : Hit<float>{limit_[l], SurfaceId{}, 0};
            ASSERT_TRUE(same_hit(hits[l], wanted)) << "lane " << l << ": primitive " << hits[l].primitive << " at "
                                                   << hits[l].t << " for " << wanted.primitive << " at " << wanted.t;
            met += wanted.side.exists() ? 1 : 0;
            ended += wanted.t == -1.0f ? 1 : 0;
        }
    }

    const Planted& planted_;
    lanes::Paths<float> rays_{};
    lanes::Flags asks_{};
    lanes::Lanes<float> enough_{}, limit_{};
};

// Among the scenes is a tree that no cache near a core holds, whose rays take turns.
TEST_P(NativeTest, APacketLeavesEachRaysHit) {
    std::vector<TriangleScene> scenes = triangle_scenes();
    scenes.push_back({"a large ball", grid_sphere(128, 128, {0, 0, 0}, 1)});
    std::size_t met = 0, ended = 0;
    for (const TriangleScene& scene : scenes) {
        SCOPED_TRACE(scene.name);
        Planted planted(scene.triangles, hook_of(GetParam()));
        if (!planted.has_lanes()) {
            GTEST_SKIP() << "it has no search for packets";
        }
        for (const bool elsewhere : {false, true}) {
            if (elsewhere) {
                planted.place_elsewhere();
            }
            LanesBesideRays both(planted);
            both.take(rays_for(scene.triangles, 2000, 11));
            met += both.met;
            ended += both.ended;
        }
    }
    EXPECT_GT(met, 10000u);
    EXPECT_GT(ended, 1000u);
}

TEST_P(NativeTest, APacketMeetsNothingOfNothing) {
    const Planted planted({}, hook_of(GetParam()));
    if (!planted.has_lanes()) {
        GTEST_SKIP() << "it has no search for packets";
    }
    LanesBesideRays both(planted);
    both.take(rays_for(grid_sphere(4, 4, {0, 0, 0}, 1), 128, 12));
    EXPECT_EQ(both.met, 0u);
}

INSTANTIATE_TEST_SUITE_P(Accelerators, NativeTest, testing::Values("bvh4", "bvh8", "embree"),
                         [](const auto& choice) { return std::string(choice.param); });

TEST(EmbreeNativeTest, MeetsWhatBruteForceMeets) {
    if (Registry::instance().find("accelerator", "embree_native") == nullptr) {
        GTEST_SKIP() << "this build has no accelerator=embree_native";
    }
    const Triangles triangles = random_soup(4000, 0.2f, 3);
    const Planted expected(triangles, hook_of("brute_force")), planted(triangles, hook_of("embree_native"));
    // Directions at random from points at random: rays_for's aim at edges and vertices, where the tests may differ.
    const std::vector<TestRay> starts = rays_for(triangles, 20000, 8), turns = rays_for(triangles, 20000, 9);
    std::size_t hits = 0, same = 0;
    for (std::size_t i = 0; i < starts.size(); ++i) {
        const Vec3<float> d = starts[i].direction + turns[i].direction * 0.37f;
        const Ray<float> ray = ray_of({starts[i].origin * 0.9f + turns[i].origin * 0.1f, d});
        const Hit<float> wanted = expected.closest(ray), found = planted.closest(ray);
        hits += wanted.side.exists() ? 1 : 0;
        if (same_place(wanted, found)) {
            ++same;
            if (wanted.side.exists()) {
                // The error is relative to the distance, or to the coordinates (about 1), whose rounding a short
                // distance has too.
                EXPECT_NEAR(found.t, wanted.t, 1e-5f * std::max(wanted.t, 1.0f));
            }
        }
    }
    EXPECT_GT(hits, starts.size() / 10);
    EXPECT_GT(same, starts.size() - starts.size() / 1000);
}

// Up to rounding of the distances: what is met well before the limit ends the search, what is met well beyond does not,
// and neither does the triangle that a ray starts on.
TEST(EmbreeNativeTest, AnyHitBeforeADistanceEndsTheSearch) {
    if (Registry::instance().find("accelerator", "embree_native") == nullptr) {
        GTEST_SKIP() << "this build has no accelerator=embree_native";
    }
    const Triangles triangles = random_soup(2000, 0.2f, 4);
    const Planted planted(triangles, hook_of("embree_native"));
    const std::vector<TestRay> starts = rays_for(triangles, 8000, 8), turns = rays_for(triangles, 8000, 9);
    std::size_t hits = 0, right = 0;
    for (std::size_t i = 0; i < starts.size(); ++i) {
        const Vec3<float> d = starts[i].direction + turns[i].direction * 0.37f;
        Ray<float> ray = ray_of({starts[i].origin * 0.9f + turns[i].origin * 0.1f, d});
        const Hit<float> closest = planted.closest(ray);
        if (!closest.side.exists() || closest.t < 1e-3f) {
            continue;
        }
        ++hits;
        const bool is_ended = planted.nearer_than(ray, 4 * closest.t, 1.001f * closest.t).t == -1.0f;
        const bool is_closest = same_place(planted.nearer_than(ray, 4 * closest.t, 0.999f * closest.t), closest);
        const bool is_missed = !planted.nearer_than(ray, 0.999f * closest.t, 0.9f * closest.t).side.exists();
        ray.origin_surface = closest.side;
        ray.primitive = closest.primitive;
        const Hit<float> next = planted.closest(ray);
        const float between = next.side.exists() ? 0.5f * (closest.t + next.t) : 2 * closest.t;
        const bool is_left = !planted.nearer_than(ray, between, between).side.exists() || next.t < 1.001f * closest.t;
        right += is_ended && is_closest && is_missed && is_left ? 1 : 0;
    }
    EXPECT_GT(hits, 1000u);
    EXPECT_GT(right, hits - hits / 500);
}

TEST(EmbreeBuilderTest, BuildsAWholeTreeOfAnyTriangles) {
    const Choice* choice = Registry::instance().find("builder", "embree");
    if (choice == nullptr) {
        GTEST_SKIP() << "this build has no builder=embree";
    }
    const Triangles all[] = {{},
                             equal_triangles(1),
                             equal_triangles(300),
                             flat_triangles(300, 5),
                             geometric_progression(120),
                             needles(2000, 1e6f, 3),
                             grid_sphere(60, 90, {0, 0, 0}, 1)};
    for (const Triangles& triangles : all) {
        const PrimitiveBoxes boxes = boxes_of(triangles);
        const BinaryTree tree = choice->hook.builder.build(boxes, triangles);
        EXPECT_NO_THROW(builder::check(tree, boxes)) << triangles.size();
        EXPECT_EQ(choice->hook.builder.build(boxes, triangles).references, tree.references) << triangles.size();
    }
    // Embree's planes are chosen by the same heuristic as those of sah_binned, from more bins.
    EXPECT_LT(builder::tree_cost(choice->hook.builder.build(boxes_of(all[6]), all[6])),
              1.1 * builder::tree_cost(builder::sah_binned::build(boxes_of(all[6]))));
}

}  // namespace
}  // namespace pt::test
