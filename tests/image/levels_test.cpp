// The ways to objects that show meshes, a tree over them and one tree over all their triangles: hits and films of each
// object in turn, bit for bit, whatever the objects' transforms, and what the choices refuse.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "harness/bench/suite.h"
#include "harness/bench/verify.h"
#include "harness/mesh/generate.h"
#include "harness/scene/instances.h"
#include "harness/scene/scene_mesh.h"
#include "tests/support/render.h"
#include "tests/support/scenes.h"

namespace pt {
namespace {

using test::SceneBuilder;

Variant variant_with(const std::map<std::string, std::string>& choices) {
    Variant variant = Registry::instance().baseline();
    for (const auto& [axis, choice] : choices) {
        variant.set(axis, choice);
    }
    return variant;
}

RenderResult rendered(const Scene& scene, const Variant& variant) {
    RenderRequest request;
    request.variant = variant;
    request.settings = default_settings(scene);
    request.settings.seed = 5;
    request.samples = 2;
    return pt::render(scene, request);
}

// Instances of two meshes, overlapping, turned and stretched, some moving, one that shines, and a mesh of one object.
Scene crowd(std::uint32_t count) {
    SceneBuilder builder;
    const std::uint32_t white = builder.diffuse(Vec3d(0.75)), lamp = builder.emitter(Vec3d(4));
    const std::uint32_t metal = builder.mirror(Vec3d(0.9));
    builder.room(white, {0, 0, 0}, {3, 3, 3});
    std::mt19937 random(3);
    std::uniform_real_distribution<double> unit(-1, 1);
    for (std::uint32_t i = 0; i < count; ++i) {
        const bool is_ball = i % 2 == 0;
        SceneObject& object =
            builder.mesh(i % 5 == 1 ? metal : white, is_ball ? "icosphere" : "trefoil", is_ball ? 1 : 3,
                         {2.5 * unit(random), 2.5 * unit(random), 2.5 * unit(random)}, 1,
                         {180 * unit(random), 180 * unit(random), 180 * unit(random)});
        object.scale = {std::exp2(unit(random) - 2), std::exp2(unit(random) - 2), std::exp2(2 * unit(random) - 3)};
        object.velocity = i % 3 == 0 ? Vec3d(unit(random), unit(random), unit(random)) : Vec3d(0.0);
    }
    builder.mesh(lamp, "icosphere", 1, {0, 2, 0}, 0.5, {10, 20, 30}).velocity = {0.25, 0, 0};
    builder.mesh(white, "menger", 1, {-1, -2, 0.5}, 1, {0, 30, 0});
    builder.camera({0, 0, -2.9}, {0, 0, 1}).image(24, 24, 90, true).depth(5);
    builder.scene.camera.shutter_open = -0.5;
    builder.scene.camera.shutter_close = 0.75;
    return builder.scene;
}

TEST(LevelsTest, EveryWayLeavesTheFilmOfEachObject) {
    const Scene scene = crowd(60);
    const std::string expected = rendered(scene, variant_with({})).film.hash();
    std::size_t held = 0;
    for (const char* precision : {"float", "double"}) {
        const std::map<std::string, std::string> in{
            {"precision", precision}, {"integrator", "depth_first"}, {"specialisation", "generic"}};
        const std::string in_turn = rendered(scene, variant_with(in)).film.hash();
        EXPECT_EQ(in_turn == expected, std::string(precision) == "float");
        for (const Choice* levels : Registry::instance().choices("levels")) {
            for (const Choice* accelerator : Registry::instance().choices("accelerator")) {
                std::map<std::string, std::string> choices = in;
                choices["levels"] = levels->descriptor.name;
                choices["accelerator"] = accelerator->descriptor.name;
                const Variant variant = variant_with(choices);
                if (claim_of(variant) == Claim::biased || accelerator->descriptor.claim != Claim::bitwise ||
                    !why_not_applicable(variant, features_of(scene)).empty()) {
                    continue;
                }
                EXPECT_EQ(rendered(scene, variant).film.hash(), in_turn) << variant.spelled_out();
                ++held;
            }
        }
    }
    // Twice: each object and two levels by every accelerator, one tree by those that have trees.
    EXPECT_GE(held, 2u * (5 + 5 + 4));
}

TEST(LevelsTest, EveryVariantOfTheAxisIsVerified) {
    const Scene scene = crowd(20);
    RenderSettings settings = default_settings(scene);
    settings.width = settings.height = 8;
    settings.seed = 11;
    Verifier verifier(scene, settings, 2);
    AxisChoices axes = all_choices();
    axes["direct_light"] = {"off", "nee_mis"};
    axes["russian_roulette"] = {"off"};
    axes["sampler"] = {"pcg4d"};
    axes["arithmetic"] = {"exact"};
    std::map<std::string, std::size_t> held;
    for (const Variant& variant : covering_variants(axes, features_of(scene), Backend::cpu)) {
        const Verdict verdict = verifier.check(variant);
        EXPECT_TRUE(verdict.holds) << variant.spelled_out() << ": " << verdict.message;
        ++held[variant["levels"]];
    }
    for (const char* name : {"each_object", "two_level", "flat"}) {
        EXPECT_GT(held[name], 4u) << name;
    }
}

// ---- Rays at edges and corners ----

template <class Real>
using Searching = Config<Real, Feature::mesh | Feature::motion, RunTimeAccelerator>;

// A scene of a few instances of a ball of 20 triangles, placed by `place(object)`.
template <class Place>
Scene balls(std::uint32_t count, const Place& place) {
    SceneBuilder builder;
    const std::uint32_t white = builder.diffuse(Vec3d(0.5));
    const auto ball = make_scene_mesh(generate_mesh("icosphere", 0), "ball");
    for (std::uint32_t i = 0; i < count; ++i) {
        place(builder.mesh(white, ball, {0, 0, 0}, 1));
    }
    return builder.scene;
}

// Rays from points of the objects, and of the space round them, to corners, edges and inner points of triangles.
template <class Real>
class Rays {
public:
    Rays(const SceneView<Real>& scene, std::uint32_t seed) : scene_(scene), random_(seed) {}

    Ray<Real> next() {
        const Real time = scene_.camera.shutter_open + scene_.camera.shutter_length * static_cast<Real>(unit());
        Vec3<Real> from, way;
        Real size = Real(0);
        while (!(size > Real(0))) {
            from = point(time);
            way = point(time) - from;
            size = square_root(dot(way, way));
        }
        return {from, way * (Real(1) / size), time, {}, 0};
    }

private:
    double unit() { return std::generate_canonical<double, 32>(random_); }
    Vec3<Real> point(Real time) {
        const auto object = static_cast<std::uint32_t>(unit() * scene_.meshes.size);
        const MeshInstance<Real>& mesh = scene_.meshes[object];
        const auto primitive = static_cast<std::uint32_t>(unit() * mesh.geometry.triangle_count);
        const Triangle<Real> t = mesh.triangle(primitive);
        Real u = static_cast<Real>(unit()), v = (Real(1) - u) * static_cast<Real>(unit());
        const int kind = static_cast<int>(unit() * 4);
        u = kind == 0 ? Real(1) : u;
        v = kind <= 1 ? Real(0) : v;
        const Vec3<Real> p = t.a * u + t.b * v + t.c * (Real(1) - u - v);
        // A quarter of them off the surface, which is where walks through a body start.
        return mesh.point_out(p * (kind == 3 ? static_cast<Real>(unit()) : Real(1))) + scene_.velocity[object] * time;
    }

    const SceneView<Real>& scene_;
    std::mt19937 random_;
};

template <class Real>
void expect_same_hits(const Scene& scene, const std::string& name, std::uint32_t rays) {
    const RenderSettings settings = default_settings(scene);
    const SceneBuffers<Real> plain(scene, settings, Acceleration::of(variant_with({}), Backend::cpu));
    for (const std::string levels : {"two_level", "flat"}) {
        const Variant variant = variant_with({{"levels", levels}, {"accelerator", "bvh2"}});
        const SceneBuffers<Real> buffers(scene, settings, Acceleration::of(variant, Backend::cpu));
        ASSERT_NE(buffers.tree(), nullptr);
        Rays<Real> source(plain.view(), 17);
        std::uint32_t hits = 0, wrong = 0;
        for (std::uint32_t i = 0; i < rays; ++i) {
            const Ray<Real> ray = source.next();
            const Hit<Real> a = closest_hit<Searching<Real>>(plain.view(), ray);
            const Hit<Real> b = closest_hit<Searching<Real>>(buffers.view(), ray);
            hits += a.side.exists() ? 1 : 0;
            wrong += a.t != b.t || a.side.code != b.side.code || a.primitive != b.primitive ? 1 : 0;
        }
        EXPECT_EQ(wrong, 0u) << name << " " << levels << ", of " << hits << " hits";
        EXPECT_GT(hits, rays / 4) << name;
    }
}

TEST(LevelsTest, BoxesHoldWhatTheInstancesOwnSpaceMeets) {
    std::mt19937 random(9);
    const auto unit = [&] { return std::uniform_real_distribution<double>(-1, 1)(random); };
    const auto anywhere = [&](double reach) { return Vec3d(reach * unit(), reach * unit(), reach * unit()); };
    const struct {
        const char* name;
        double reach;        // of the objects' places, from the eye
        double least, most;  // powers of 2 of the scales
        bool is_even;        // the same scale on all axes
        double speed;
    } cases[] = {{"even", 4, -1, 1, true, 0},
                 {"stretched", 4, -10, 1, false, 0},
                 {"slivers", 8, -20, 2, false, 0},
                 {"far from the eye", 1e5, -2, 2, false, 0},
                 {"tiny and far", 1e3, -9, -8, true, 0},
                 {"huge", 1e9, 28, 30, false, 0},
                 {"moving", 4, -4, 1, false, 8},
                 {"moving, far from the eye", 1e5, -1, 3, false, 1e4}};
    for (const auto& c : cases) {
        Scene scene = balls(24, [&](SceneObject& object) {
            object.translate = anywhere(c.reach);
            object.rotate_degrees = anywhere(180);
            for (int axis = 0; axis < 3; ++axis) {
                object.scale[axis] = axis > 0 && c.is_even
                                         ? object.scale[0]
                                         : std::exp2(c.least + (c.most - c.least) * 0.5 * (unit() + 1));
            }
            object.velocity = anywhere(c.speed);
        });
        scene.camera.shutter_open = c.speed > 0 ? -1 : 0;
        scene.camera.shutter_close = c.speed > 0 ? 2 : 0;
        expect_same_hits<float>(scene, c.name, 100000);
        expect_same_hits<double>(scene, c.name, 20000);
    }
}

// Faces that lie in the sides of their boxes, and rays along them: nothing but the margin keeps those.
TEST(LevelsTest, FacesInTheSidesOfBoxesAreMet) {
    std::mt19937 random(10);
    const auto unit = [&] { return std::uniform_real_distribution<double>(-1, 1)(random); };
    SceneBuilder builder;
    const std::uint32_t white = builder.diffuse(Vec3d(0.5));
    Mesh square;
    square.vertices = {{-0.5f, 0, -0.5f}, {0.5f, 0, -0.5f}, {0.5f, 0, 0.5f}, {-0.5f, 0, 0.5f}};
    square.triangles = {{0, 2, 1}, {0, 3, 2}};
    const auto mesh = make_scene_mesh(square, "square");
    for (int i = 0; i < 40; ++i) {
        builder.mesh(white, mesh, {10 * unit(), 10 * unit(), 10 * unit()}, std::exp2(2 * unit()),
                     {0, 0, i % 2 == 0 ? 0.0 : 90.0 * unit()});
    }
    expect_same_hits<float>(builder.scene, "squares", 200000);
}

TEST(LevelsTest, OneObjectAndManyAtOnePlace) {
    for (const std::uint32_t count : {1u, 2u, 33u}) {
        const Scene scene = balls(count, [](SceneObject& object) { object.translate = {0, 0, 4}; });
        expect_same_hits<float>(scene, std::to_string(count), 20000);
    }
}

TEST(LevelsTest, ARayOfNaNsComesToAnEnd) {
    for (const std::uint32_t count : {1u, 5u}) {
        const Scene scene = balls(count, [](SceneObject& object) { object.translate = {0, 0, 4}; });
        for (const std::string levels : {"each_object", "two_level"}) {
            for (const std::string accelerator : {"brute_force", "bvh2"}) {
                const Variant variant = variant_with({{"levels", levels}, {"accelerator", accelerator}});
                const SceneBuffers<float> buffers(scene, default_settings(scene),
                                                  Acceleration::of(variant, Backend::cpu));
                const float nan = std::numeric_limits<float>::quiet_NaN();
                const Ray<float> ray{{0, 0, 0}, {nan, nan, nan}, 0, {}, 0};
                EXPECT_FALSE(closest_hit<Searching<float>>(buffers.view(), ray).side.exists());
            }
        }
    }
}

// ---- What they say and refuse ----

TEST(LevelsTest, ARenderSaysWhatTheTreeTakes) {
    const Scene scene = crowd(60);
    const auto facts = [&](const char* levels) {
        return rendered(scene, variant_with({{"levels", levels}, {"accelerator", "bvh2"}})).meshes;
    };
    EXPECT_EQ(facts("each_object").level_nodes, 0u);
    EXPECT_EQ(facts("each_object").level_bytes, 0u);
    EXPECT_EQ(facts("two_level").level_nodes, 61u);  // a node less than the 62 objects
    EXPECT_EQ(facts("two_level").level_bytes, 61u * sizeof(ObjectNode));
    // 30 balls and the lamp of 80 triangles, 30 knots of 144, the sponge of 144.
    const MeshFacts flat = facts("flat");
    const std::uint64_t slots = 31 * 80 + 30 * 144 + 144;
    EXPECT_EQ(flat.level_bytes, flat.level_nodes * 64 + slots * sizeof(FlatSlot));
    EXPECT_GT(flat.level_nodes, slots / 16);
    EXPECT_GT(flat.level_build_ms, 0);
    // Whose own trees stay as they are.
    EXPECT_EQ(flat.nodes, facts("each_object").nodes);
}

TEST(LevelsTest, RefusesWhatItCannotDo) {
    const FeatureSet with_mesh = features_of(crowd(1));
    const auto reason = [&](const std::map<std::string, std::string>& choices, FeatureSet scene) {
        return reason_not_applicable(variant_with(choices), scene).code;
    };
    EXPECT_EQ(reason({{"levels", "two_level"}}, with_mesh), "");
    EXPECT_EQ(reason({{"levels", "two_level"}}, no_features | Feature::sphere), "needs_meshes");
    EXPECT_EQ(reason({{"levels", "flat"}, {"accelerator", "bvh4"}}, with_mesh), "");
    EXPECT_EQ(reason({{"levels", "flat"}, {"accelerator", "bvh4"}}, no_features | Feature::sphere), "needs_meshes");
    EXPECT_EQ(reason({{"levels", "flat"}}, with_mesh), "needs_tree");
    EXPECT_EQ(reason({{"levels", "flat"}, {"accelerator", "bvh2"}, {"builder", "sbvh"}}, with_mesh),
              "splits_primitives");
    if (Registry::instance().find("traversal", "persistent", Backend::cuda) == nullptr) {
        return;
    }
    Variant fetching = Registry::instance().baseline(Backend::cuda);
    for (const auto& [axis, choice] : {std::pair{"accelerator", "bvh2"}, {"traversal", "persistent"}}) {
        fetching.set(axis, choice);
    }
    EXPECT_EQ(why_not_applicable(fetching, with_mesh, Backend::cuda), "");
    for (const char* levels : {"two_level", "flat"}) {
        fetching.set("levels", levels);
        EXPECT_EQ(reason_not_applicable(fetching, with_mesh, Backend::cuda).code, "needs_search") << levels;
    }
}

TEST(LevelsTest, AFlatTreeHasItsLimit) {
    SceneBuilder builder;
    const std::uint32_t white = builder.diffuse(Vec3d(0.5));
    SceneObject object = builder.mesh(white, "icosphere", 8, {0, 0, 5}, 1);
    for (const Copy& copy : field(5, 3, 1)) {
        builder.scene.objects.push_back(copied(object, copy));
    }
    const Variant variant = variant_with({{"levels", "flat"}, {"accelerator", "bvh2"}});
    try {
        rendered(builder.scene, variant);
        FAIL() << "34 million triangles were taken";
    } catch (const InputError& error) {
        EXPECT_EQ(std::string(error.what()),
                  "levels=flat: found 34078720 triangles, instances included, allowed: at "
                  "most 33554432");
    }
}

}  // namespace
}  // namespace pt
