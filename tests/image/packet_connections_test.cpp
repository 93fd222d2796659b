// Packets that connect their vertices to lights over all lanes at once leave the film of a path at a time, to the last
// bit, with as many rays: over lights of every kind, near, far and round the vertex, moving ones, and every weighting.
#include <algorithm>
#include <functional>

#include <gtest/gtest.h>

#include "harness/scene/places.h"
#include "tests/support/stage.h"
#include "variants/integrator/packet.h"

namespace pt {
namespace {

using test::lamp;
using test::SceneBuilder;
using test::stage;

constexpr FeatureSet connections = Feature::next_event | Feature::multiple_importance;
constexpr FeatureSet boxes_and_balls = connections | Feature::sphere | Feature::axis_box | Feature::diffuse |
                                       Feature::emitter | Feature::mirror | Feature::jitter;
constexpr FeatureSet every_kind = boxes_and_balls | Feature::quad | Feature::ellipsoid | Feature::oriented_box |
                                  Feature::mix | Feature::dielectric | Feature::rough_conductor;
constexpr FeatureSet in_motion = every_kind | Feature::motion;
constexpr FeatureSet with_meshes = every_kind | Feature::mesh;

struct Outcome {
    std::string film;
    WorkCounters work;
    bool is_lit;
};

template <class Kernel>
Outcome outcome(const Scene& scene, const RenderSettings& settings, void (*render)(RenderJob&)) {
    static_assert(lanes::shades_in_lanes<Kernel>);
    constexpr std::uint32_t samples = 7;  // not a whole number of packets
    const SceneBuffers<float> buffers(scene, settings);
    Film film(settings.width, settings.height, radiance_bound(scene, settings), samples);
    RenderJob job{};
    job.scene = buffers.view();
    job.film = film.view();
    job.samples = samples;
    render(job);
    return {film.hash(), job.work, film.mean() != Vec3d(0.0)};
}

template <FeatureSet features>
void expect_one_film_as_drawn(const Scene& scene, const std::string& name) {
    using Kernel = Config<float, features>;
    RenderSettings settings = default_settings(scene);
    settings.light_sampling = light_sampling_in(features);
    settings.near_light = 20;
    settings.width = settings.height = 24;
    settings.depth = std::max(settings.depth, 4u);
    settings.seed = 3;
    settings.next_event = true;
    for (const std::uint32_t exponent : {0u, 1u, 2u}) {
        SCOPED_TRACE(name + ", exponent " + std::to_string(exponent));
        settings.mis_exponent = exponent;
        const Outcome alone = outcome<Kernel>(scene, settings, &integrator::depth_first::render<Kernel>);
        const Outcome packet = outcome<Kernel>(scene, settings, &integrator::packet::render<Kernel>);
        EXPECT_EQ(packet.film, alone.film);
        EXPECT_EQ(packet.work.rays, alone.work.rays);
        EXPECT_EQ(packet.work.connections, alone.work.connections);
        EXPECT_EQ(packet.work.paths, alone.work.paths);
        EXPECT_GT(packet.work.connections, 100u);
        EXPECT_TRUE(packet.is_lit);
    }
}

// However points on lights are drawn.
template <FeatureSet features>
void expect_one_film(const Scene& scene, const std::string& name) {
    expect_one_film_as_drawn<features>(scene, name + ", solid angle");
    expect_one_film_as_drawn<(features | Feature::area_sampling)>(scene, name + ", area");
    expect_one_film_as_drawn<(features | Feature::projected_sampling)>(scene, name + ", projected");
    expect_one_film_as_drawn<(features | Feature::automatic_sampling)>(scene, name + ", automatic");
}

TEST(PacketConnections, OfShippedRooms) {
    for (const char* const name : {"cornell_open", "cornell_closed", "cornell_open_45", "small_light"}) {
        expect_one_film<(boxes_and_balls | Feature::enclosure)>(find_scene(name), name);
        expect_one_film<boxes_and_balls>(find_scene(name), name);
    }
    expect_one_film<every_kind>(find_scene("many_lights"), "many_lights");
}

TEST(PacketConnections, OfEveryKindOfLight) {
    const std::function<void(SceneBuilder&)> lights[] = {
        lamp,
        [](auto& b) {
            b.box(b.emitter({4, 5, 6}), {0.5, 2.8, -1}, {1, 0.5, 2});
        },
        // Far; a thread; one without height, of which most vertices see one side.
        [](auto& b) {
            b.box(b.emitter({4, 5, 6}), {0.5, 30, -1}, {3, 3, 3});
        },
        [](auto& b) {
            b.box(b.emitter({400, 500, 600}), {0.5, 2.8, -1}, {0.0001, 0.0001, 2});
        },
        [](auto& b) {
            b.box(b.emitter({4, 5, 6}), {0.5, 2.8, -1}, {2, 0.00001, 2});
        },
        // The box stands on the floor and against the wall.
        [](auto& b) {
            b.box(b.emitter({4, 5, 6}), {1.5, 0.5, 1.75}, {1, 1, 0.5});
        },
        [](auto& b) {
            lamp(b);
            b.box(b.emitter({6, 1, 1}), {-2, 2, -1}, Vec3d(0.8));
            b.box(b.emitter({1, 6, 1}), {2, 2, -1}, Vec3d(0.8), {20, 30, 40});
            b.box(b.emitter({1, 1, 6}), {2, 20, -1}, Vec3d(0.5));
            b.quad(b.emitter({1, 1, 6}), {2, 2.5, -1}, 1, 1, {0, 0, 150});
            b.ellipsoid(b.emitter({4, 5, 6}), {0.5, 2.8, -1}, {2.5, 0.4, 1}, {20, 30, 40});
        },
    };
    for (std::size_t i = 0; i < std::size(lights); ++i) {
        expect_one_film<every_kind>(stage(lights[i]), "light " + std::to_string(i));
    }
}

// The vertices of the ball see no face of the lamp from outside.
TEST(PacketConnections, WithinALamp) {
    SceneBuilder builder;
    builder.camera({0, 0, -1.5}, {0, 0, 0}).image(16, 16, 60, true);
    builder.box(builder.emitter(Vec3d(2)), {0, 0, 0}, {4, 4, 4});
    builder.sphere(builder.diffuse(Vec3d(0.7)), {0, 0, 0}, 0.9);
    expect_one_film<boxes_and_balls>(builder.scene, "within");
}

TEST(PacketConnections, BesideOtherMaterials) {
    const std::function<std::uint32_t(SceneBuilder&)> balls[] = {
        [](auto& b) {
            return b.mirror({0.9, 0.8, 0.7});
        },
        [](auto& b) { return b.dielectric(1.5); },
        [](auto& b) {
            return b.mix({0.75, 0.5, 0.25}, {0.9, 0.8, 0.7}, 0.4);
        },
        [](auto& b) {
            return b.rough_conductor({0.9, 0.8, 0.7}, 0.4);
        },
    };
    for (std::size_t i = 0; i < std::size(balls); ++i) {
        expect_one_film<every_kind>(stage(lamp, balls[i]), "ball " + std::to_string(i));
    }
}

TEST(PacketConnections, OfWhatMoves) {
    Scene scene = stage([](auto& b) {
        b.sphere(b.emitter({4, 5, 6}), {-1.5, 3, -1}, 1.2).velocity = {3, 0, 0};
        b.box(b.emitter({4, 5, 6}), {1, 3, -1}, {1, 0.3, 1}).velocity = {0, 1, 0};
        b.box(b.diffuse(Vec3d(0.5)), {-1, 2, -0.5}, {0.8, 0.1, 0.8}).velocity = {0, -1, 0.5};
    });
    scene.camera.shutter_close = 1;
    expect_one_film<in_motion>(scene, "moving");
}

// An open book of four triangles: paths run from page to page, so that a ray which passed over another triangle than
// the one that it starts on would leave through it.
std::shared_ptr<const SceneMesh> book() {
    Mesh mesh;
    mesh.vertices = {{0, 0, -0.5f},       {0, 0, 0.5f},        {-0.4f, 0.5f, -0.5f},
                     {-0.4f, 0.5f, 0.5f}, {0.4f, 0.5f, -0.5f}, {0.4f, 0.5f, 0.5f}};
    mesh.triangles = {{0, 1, 3}, {0, 3, 2}, {0, 5, 1}, {0, 4, 5}};
    return make_scene_mesh(mesh, "book");
}

TEST(PacketConnections, BetweenThePagesOfABook) {
    expect_one_film<with_meshes>(stage([](SceneBuilder& b) {
                                     b.box(b.emitter({4, 5, 6}), {-0.9, 2.6, -1}, {0.6, 0.1, 0.6});
                                     b.mesh(b.diffuse(Vec3d(0.9)), book(), {0, 1, -1.2}, 1.5, {-50, 0, 0});
                                 }),
                                 "book");
}

// The icosahedra touch each other, and one of them is a lamp or is lit by one.
TEST(PacketConnections, OverMeshes) {
    const auto balls = [](SceneBuilder& b) {
        b.mesh(b.diffuse(Vec3d(0.7)), "icosphere", 1, {-0.6, 1, -0.5}, 0.6);
        b.mesh(b.mirror({0.9, 0.8, 0.7}), "icosphere", 0, {0.6, 0.8, 0}, 0.6);
        b.mesh(b.dielectric(1.5), "icosphere", 2, {0, 1.8, 0.3}, 0.5);
    };
    const std::function<void(SceneBuilder&)> lights[] = {
        lamp,
        [](auto& b) {
            b.mesh(b.emitter({4, 5, 6}), "icosphere", 1, {0.5, 2.8, -1}, 0.7);
        },
        [](auto& b) {
            lamp(b);
            b.mesh(b.emitter({4, 5, 6}), "icosphere", 0, {-1.2, 2.2, -1}, 0.4);
        },
    };
    for (std::size_t i = 0; i < std::size(lights); ++i) {
        const auto all = [&](SceneBuilder& b) {
            lights[i](b);
            balls(b);
        };
        expect_one_film<with_meshes>(stage(all), "meshes, light " + std::to_string(i));
    }
}

TEST(PacketConnections, OverMeshesThatMove) {
    Scene scene = stage([](auto& b) {
        lamp(b);
        b.mesh(b.diffuse(Vec3d(0.7)), "icosphere", 1, {-0.6, 1, -0.5}, 0.6).velocity = {2, 0, 1};
        b.mesh(b.emitter({4, 5, 6}), "icosphere", 1, {0.5, 2, -1}, 0.5).velocity = {0, 1, 0};
    });
    scene.camera.shutter_close = 1;
    expect_one_film<(with_meshes | Feature::motion)>(scene, "moving meshes");
}

// A kernel with connections whose variant asks for none.
TEST(PacketConnections, AreLeftOutWhereNotAskedFor) {
    const Scene scene = find_scene("cornell_open");
    RenderSettings settings = default_settings(scene);
    settings.width = settings.height = 24;
    using With = Config<float, boxes_and_balls>;
    using Without = Config<float, boxes_and_balls & ~connections>;
    const Outcome with = outcome<With>(scene, settings, &integrator::packet::render<With>);
    EXPECT_EQ(with.film, outcome<Without>(scene, settings, &integrator::packet::render<Without>).film);
    EXPECT_EQ(with.work.connections, 0u);
}

}  // namespace
}  // namespace pt
