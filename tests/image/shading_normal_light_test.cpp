// Normals that surfaces are shaded with (kernels/shading_normal.h): of a ball's corners they are the ball's; an image
// turns them towards u and v; and of an even light, of connections and of mirrors what is left is what the two normals
// let through.
#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "harness/scene/scene_mesh.h"
#include "kernels/shade.h"
#include "tests/support/connections.h"
#include "tests/support/shading_normals.h"
#include "tests/support/stage.h"

namespace pt {
namespace {

using test::ball_mesh;
using test::bumpy_texels;
using test::Kind;
using test::kinds;
using test::RenderOptions;
using test::SceneBuilder;
using test::tilted;

template <class Real>
class ShadingNormalLightTest : public testing::Test {};
using Reals = testing::Types<float, double>;
TYPED_TEST_SUITE(ShadingNormalLightTest, Reals);

template <class Real>
using Everything = Config<Real, all_features | samplers | traversals>;

// Where the corners of a triangle lie on a ball about the origin and have its normals, what is blended between them is
// the ball's normal along the very point; a placement moves it as it does a plane.
TYPED_TEST(ShadingNormalLightTest, BlendedOverABallAreTheBalls) {
    using Real = TypeParam;
    const Vec3d stretches[] = {Vec3d(1.0), {2, 0.5, 1}};
    for (const Vec3d& scale : stretches) {
        for (const bool is_shared : {false, true}) {
            SceneBuilder builder;
            builder.camera({0, 1, -5}, {0, 0, 0}).image(32, 32, 40, true);
            const auto ball = make_scene_mesh(ball_mesh(8), "ball", true);
            const std::uint32_t grey = builder.diffuse(Vec3d(0.5));
            const auto add = [&](const Vec3d& centre) {
                SceneObject& object = builder.mesh(grey, ball, centre, 1, {30, 20, 10});
                object.scale = scale;
                object.shading_normals = true;
            };
            add({0, 0, 0});
            if (is_shared) {
                add({100, 0, 0});
            }
            const test::Stages<Real> stages(builder.scene);
            const Rotation rotation = rotation_of({30, 20, 10});
            int met = 0;
            for (std::uint32_t pixel = 0; pixel < 32 * 32; ++pixel) {
                const Ray<Real> ray = ray_of(stages.generate(pixel, 0));
                const Hit<Real> hit = stages.intersect(ray);
                if (!hit.side.exists()) {
                    continue;
                }
                const SurfacePoint<Real> point = stages.surface(ray, hit);
                const Vec3d found(
                    shading_normal_at<Everything<Real>>(stages.view(), ray, hit, point.position, point.normal));
                const Vec3d place = Vec3d(point.position) + builder.scene.camera.eye;
                Vec3d expected(0.0);
                for (int axis = 0; axis < 3; ++axis) {
                    const double local = dot(rotation.column[axis], place) / scale[axis];
                    expected += rotation.column[axis] * (local / scale[axis]);
                }
                expected = normalize(expected);
                // Vertices and their normals are single precision numbers in both precisions; a point of float keeps
                // off its triangle's plane and edges by up to 16 roundings of lengths up to 8, stretched by 4, and
                // their normals once more.
                const double rounding = sizeof(Real) == 4 ? 16 * 8 * 16 * 0x1p-24 : 16 * 0x1p-24;
                EXPECT_LT(std::sqrt(dot(found - expected, found - expected)), rounding) << pixel;
                ++met;
            }
            EXPECT_GT(met, 100);
        }
    }
}

// A lamp so far off and small that its light comes from one direction: a diffuse ball of few triangles has, wherever
// its triangles face the lamp, the light of the round ball, albedo / pi * radiance * solid angle * cosine.
TYPED_TEST(ShadingNormalLightTest, ABallOfTrianglesIsLitAsARoundOne) {
    using Real = TypeParam;
    constexpr double albedo = 0.5, distance = 1000, radius = 0.5, radiance = 1e6;
    const Vec3d to_lamp = normalize(Vec3d(1, 2, -2));
    SceneBuilder builder;
    builder.camera({0, 0.5, -5}, {0, 0, 0}).image(32, 32, 26, false).depth(2);
    builder.mesh(builder.diffuse(Vec3d(albedo)), make_scene_mesh(ball_mesh(8), "ball", true), {0, 0, 0}, 1)
        .shading_normals = true;
    builder.sphere(builder.emitter(Vec3d(radiance)), to_lamp * distance, 2 * radius);
    const RenderOptions options{.samples = 1, .next_event = true};
    test::Stages<Real> stages(builder.scene, options);
    int lit = 0, dark = 0;
    for (std::uint32_t pixel = 0; pixel < 32 * 32; ++pixel) {
        const Ray<Real> ray = ray_of(stages.generate(pixel, 0));
        const Hit<Real> hit = stages.intersect(ray);
        if (!hit.side.exists()) {
            continue;
        }
        const SurfacePoint<Real> point = stages.surface(ray, hit);
        const Vec3d place = Vec3d(point.position) + builder.scene.camera.eye, off = to_lamp * distance - place;
        const double square = radius * radius / dot(off, off);
        const double solid_angle = 2 * pi<double> * square / (1 + std::sqrt(1 - square));
        const Vec3d round = normalize(place), from_there = normalize(off);
        const double own = dot(Vec3d(point.normal), from_there), cosine = dot(round, from_there);
        // The lamp is seen under half a thousandth, by which a cosine may differ.
        constexpr double lamp_size = 1e-3;
        if (dot(round, Vec3d(ray.direction)) > -lamp_size || std::abs(own) < lamp_size ||
            std::abs(cosine) < lamp_size) {
            continue;
        }
        const double whole = albedo / pi<double> * radiance * solid_angle;
        const bool is_lit = own > 0 && cosine > 0;
        EXPECT_NEAR(stages.radiance(pixel, 0).x, is_lit ? whole * cosine : 0, whole * lamp_size)
            << own << " " << cosine;
        lit += is_lit ? 1 : 0;
        dark += is_lit ? 0 : 1;
    }
    EXPECT_GT(lit, 200);
    EXPECT_GT(dark, 20);
}

// The change of texture coordinates where the surface's point is moved by `step`.
template <class Real>
Vec2<double> change_of_coordinates(const test::Stages<Real>& stages, const Hit<Real>& hit, const Vec3<Real>& point,
                                   const Vec3<Real>& normal, const Vec3d& step) {
    const auto at = [&](const Vec3d& off) {
        const Ray<Real> ray{point + Vec3<Real>(off) + normal * Real(0.5), -normal, Real(0), SurfaceId{}};
        const Hit<Real> again = stages.intersect(ray);
        EXPECT_TRUE(again.side.is_of(hit.side.object()));
        return texture_coordinates_at<Everything<Real>>(stages.view(), stages.view().object_textures[hit.side.object()],
                                                        ray, again, stages.surface(ray, again).position, normal);
    };
    const Vec2<Real> here = at(Vec3d(0.0)), there = at(step);
    return {static_cast<double>(there.x - here.x), static_cast<double>(there.y - here.y)};
}

// Texels that lean towards u turn the normal to where u grows and, on shapes whose u and v are at right angles, v
// stays; likewise v. By the angle that the texel has.
TEST(ShadingNormalMap, LeansTowardsUAndV) {
    using Real = double;
    Mesh square;
    square.vertices = {{-0.5f, -0.5f, 0}, {0.5f, -0.5f, 0}, {0.5f, 0.5f, 0}, {-0.5f, 0.5f, 0}};
    square.triangles = {{0, 1, 2}, {0, 2, 3}};
    square.coordinates = {{{{0, 0}, {0.5f, 0}, {0.5f, 1}}}, {{{0, 0}, {0.5f, 1}, {0, 1}}}};
    Mesh mirrored = square;
    for (auto& corners : mirrored.coordinates) {
        for (auto& at : corners) {
            at[0] = 1 - at[0];
        }
    }
    const std::vector<std::function<void(SceneBuilder&, std::uint32_t)>> shapes{
        [](auto& b, auto m) {
            b.quad(m, {0, 0, 0}, 3, 2, {20, 30, 40});
        },
        [](auto& b, auto m) {
            b.quad(m, {0, 0, 0}, 3, 2, {200, 30, 40});
        },
        [](auto& b, auto m) {
            b.box(m, {0, 0, 0}, {2, 2, 2}, {0, 90, 0});
        },
        [](auto& b, auto m) {
            b.box(m, {0, 0, 0}, {1.5, 2, 1}, {30, 140, 20});
        },
        [](auto& b, auto m) {
            b.box(m, {0, 0, 0}, {1.5, 2, 1}, {130, 10, 220});
        },
        [](auto& b, auto m) {
            b.sphere(m, {0, 0, 0}, 2);
        },
        [](auto& b, auto m) {
            b.ellipsoid(m, {0, 0, 0}, {2, 2, 2}, {70, 130, 20});
        },
        [&](auto& b, auto m) {
            b.mesh(m, make_scene_mesh(square, "s"), {0, 0, 0}, 3, {30, 150, 20});
        },
        [&](auto& b, auto m) {
            b.mesh(m, make_scene_mesh(mirrored, "s"), {0, 0, 0}, 3, {30, 150, 20});
        },
        [&](auto& b, auto m) {
            const auto shared = make_scene_mesh(mirrored, "s");
            b.mesh(m, shared, {0, 0, 0}, 3, {30, 150, 20});
            b.mesh(m, shared, {100, 0, 0}, 3);
        }};
    for (const auto& add : shapes) {
        for (const bool along_v : {false, true}) {
            const Vec3d lean = tilted(20);
            SceneBuilder builder;
            builder.camera({0, 1, -6}, {0, 0, 0}).image(8, 8, 20, true);
            const std::uint32_t grey = builder.diffuse(Vec3d(0.5));
            builder.normal_map(grey, 1, 1, {along_v ? Vec3d(0, lean.x, lean.z) : lean});
            add(builder, grey);
            const test::Stages<Real> stages(builder.scene);
            int met = 0;
            for (std::uint32_t pixel = 0; pixel < 64; ++pixel) {
                const Ray<Real> ray = ray_of(stages.generate(pixel, 0));
                const Hit<Real> hit = stages.intersect(ray);
                if (!hit.side.exists()) {
                    continue;
                }
                const SurfacePoint<Real> point = stages.surface(ray, hit);
                const Vec3d own = point.normal;
                const Vec3d bent = shading_normal_at<Everything<Real>>(stages.view(), ray, hit, point.position, own);
                EXPECT_NEAR(dot(bent, own), lean.z, 1e-6);  // texels are single precision numbers
                const Vec3d across = normalize(bent - own * dot(bent, own));
                constexpr double step = 1e-5;
                const Vec2<double> change =
                    change_of_coordinates<Real>(stages, hit, point.position, own, across * step);
                EXPECT_GT(along_v ? change.y : change.x, 0.05 * step);
                EXPECT_NEAR(along_v ? change.x : change.y, 0, 1e-3 * step);
                ++met;
            }
            EXPECT_GT(met, 8);
        }
    }
}

// A plate whose normal leans by an angle, in an even light.
Scene plate(double degrees, const std::function<std::uint32_t(SceneBuilder&)>& make, const Vec3d& eye = {0, 3, 0}) {
    SceneBuilder builder;
    builder.camera(eye, {0, 0, 0}, {0, 0, 1}).image(1, 1, 1e-3, false).depth(2);
    const std::uint32_t material = make(builder);
    builder.normal_map(material, 1, 1, {tilted(degrees)});
    builder.quad(material, {0, 0, 0}, 1, 1);
    return builder.scene;
}

std::uint32_t white(SceneBuilder& b) { return b.diffuse(Vec3d(1.0)); }

// A cosine-weighted hemisphere about the leaning normal has the part (1 + cos) / 2 above the plate: the half above
// both, and of the other half its image in the plane of the leaning normal's horizon.
TYPED_TEST(ShadingNormalLightTest, ADiffuseSurfaceLosesWhatLiesBehindIt) {
    const auto lit = [](double degrees, bool is_drawn) {
        Scene scene = plate(degrees, white);
        if (is_drawn) {
            SceneBuilder sky;
            sky.environment_map(2, 1, {Vec3d(1.0), Vec3d(1.0)});
            scene.environment_map = sky.scene.environment_map;
        } else {
            scene.environment = Vec3d(1.0);
        }
        return scene;
    };
    for (const double degrees : {10.0, 40.0, 75.0}) {
        const double kept = (1 + std::cos(degrees * (pi<double> / 180))) / 2;
        for (const bool is_drawn : {false, true}) {
            for (const RenderOptions& options :
                 {RenderOptions{.samples = 1 << 15}, RenderOptions{.samples = 1 << 15, .final_bounce = true},
                  RenderOptions{.samples = 1 << 15, .next_event = true},
                  RenderOptions{.samples = 1 << 15, .next_event = true, .mis_exponent = 2}}) {
                RenderOptions once = options;
                once.depth = options.final_bounce ? 1 : 2;
                const test::Mean mean = test::mean_radiance<TypeParam>(lit(degrees, is_drawn), once).channel[1];
                EXPECT_NEAR(mean.value(), kept, test::tolerated_errors * mean.standard_error() + 1e-6)
                    << degrees << " " << is_drawn;
                EXPECT_LT(mean.standard_error(), 0.01);
            }
        }
    }
}

// Seen from behind its normal a plate is black, though it faces the viewer; what it emits is seen.
TYPED_TEST(ShadingNormalLightTest, AViewerBehindTheNormalSeesNothing) {
    const Vec3d eye{-3, 1, 0};  // 18 degrees above the plate, which leans away by 30
    for (const Kind& kind : kinds) {
        if (std::string(kind.name).find("glass") == std::string::npos && std::string(kind.name) != "dielectric") {
            Scene scene = plate(30, kind.make, eye);
            scene.environment = Vec3d(1.0);
            const Vec3d emitted = scene.materials[0].emission;
            EXPECT_EQ(test::render<TypeParam>(scene, {.samples = 64}).pixel(0).x, emitted.x) << kind.name;
            // From the other side it does not lean away.
            Scene other = plate(30, kind.make, {3, 1, 0});
            other.environment = Vec3d(1.0);
            EXPECT_GT(test::render<TypeParam>(other, {.samples = 64}).pixel(0).x, 0.1) << kind.name;
        }
    }
}

// A mirror that leans by 30 degrees sends the view from above on, by 50 into itself.
TYPED_TEST(ShadingNormalLightTest, AMirrorThatSendsLightIntoItselfIsBlack) {
    const auto mirror = [](SceneBuilder& b) { return b.mirror(Vec3d(0.5)); };
    for (const auto& [degrees, expected] : {std::pair{30.0, 0.5}, {44.0, 0.5}, {46.0, 0.0}, {50.0, 0.0}}) {
        Scene scene = plate(degrees, mirror);
        scene.environment = Vec3d(1.0);
        EXPECT_EQ(test::render<TypeParam>(scene, {.samples = 16}).pixel(0).x, expected) << degrees;
    }
}

// Glass of index 1 bends no light however its normals lean; where one leans away from the viewer nothing is seen.
TYPED_TEST(ShadingNormalLightTest, GlassOfIndexOneLetsLightThrough) {
    for (const bool is_rough : {false, true}) {
        for (const double degrees : {30.0, 80.0}) {
            SceneBuilder builder;
            builder.camera({0, 3, 0}, {0, 0, 0}, {0, 0, 1}).image(1, 1, 1e-3, false).depth(3).environment(1);
            const std::uint32_t glass = is_rough ? builder.rough_dielectric(1, 0.3) : builder.dielectric(1);
            builder.normal_map(glass, 1, 1, {tilted(degrees)});
            builder.box(glass, {0, 0, 0}, {1, 1, 1});
            EXPECT_EQ(test::render<TypeParam>(builder.scene, {.samples = 16}).pixel(0).x, 1) << degrees;
        }
    }
}

// A box's face, and with it the place in an image, is told by the surface's own normal, however the other one leans.
TYPED_TEST(ShadingNormalLightTest, ARoughnessMapLiesOnTheFaceThatIsMet) {
    using Real = TypeParam;
    const auto film_of = [](bool is_drawn_on_quad) {
        SceneBuilder builder;
        builder.camera({0, 3, 0}, {0, 0, 0}, {0, 0, 1}).image(8, 8, 25, false).depth(2).environment(1);
        const std::uint32_t metal = builder.rough_conductor(Vec3d(1.0), 1);
        builder.roughness_texture(metal, 2, 2, {0.1, 0.9, 0.6, 0.3});
        builder.normal_map(metal, 1, 1, {tilted(60)});
        if (is_drawn_on_quad) {
            builder.quad(metal, {0, 0.5, 0}, 1, 1);
        } else {
            builder.box(metal, {0, 0, 0}, {1, 1, 1});
        }
        return test::render<Real>(builder.scene, {.samples = 4});
    };
    // Places on a face and on a quad may differ by a rounding, which an image's blend and a lobe pass on; a film's sum
    // of values up to 1 then differs by less than what another texel would do to it.
    const Film quad = film_of(true), box = film_of(false);
    for (std::size_t pixel = 0; pixel < 64; ++pixel) {
        EXPECT_NEAR(box.pixel(pixel).y, quad.pixel(pixel).y, 1e-4) << pixel;
    }
}

// In an even light no path carries more than the light: a surface that keeps all of it never gains.
TYPED_TEST(ShadingNormalLightTest, NoPathGainsLight) {
    const std::vector<Kind> whites{
        {"diffuse", [](auto& b) { return b.diffuse(Vec3d(1.0)); }},
        {"mirror", [](auto& b) { return b.mirror(Vec3d(1.0)); }},
        {"mix", [](auto& b) { return b.mix(Vec3d(1.0), Vec3d(1.0), 0.5); }},
        {"conductor", [](auto& b) { return b.rough_conductor(Vec3d(1.0), 0.5); }},
        {"glass", [](auto& b) { return b.dielectric(1.5); }},
        {"rough glass", [](auto& b) { return b.rough_dielectric(1.5, 0.4); }},
        {"metal", [](auto& b) { return b.principled(Vec3d(1.0), 1, 0.5); }},
    };
    for (const Kind& kind : whites) {
        SceneBuilder builder;
        builder.camera({0, 1, -4}, {0, 0, 0}).image(16, 16, 60, true).depth(20).environment(1);
        const std::uint32_t plain = kind.make(builder), mapped = kind.make(builder);
        builder.normal_map(mapped, 2, 2, bumpy_texels, 2);
        builder.mesh(plain, make_scene_mesh(ball_mesh(5), "ball", true), {-1, 0, 0}, 1).shading_normals = true;
        builder.sphere(mapped, {1, 0, 0}, 1.8);
        builder.box(mapped, {0, -1.6, 0}, {4, 1, 4});
        test::Stages<TypeParam> stages(builder.scene);
        double least = 1;
        for (std::uint32_t pixel = 0; pixel < 256; ++pixel) {
            for (std::uint32_t sample = 0; sample < 8; ++sample) {
                const Vec3d radiance = stages.radiance(pixel, sample);
                // A product of up to 20 weights, each with a few roundings.
                EXPECT_LE(radiance.y, 1 + 1e-5) << kind.name;
                least = std::min(least, radiance.y);
            }
        }
        EXPECT_EQ(least, 0) << kind.name;  // some is lost
    }
}

// Connections and what lobes meet have one mean, over normals that lean in several directions within a pixel.
TYPED_TEST(ShadingNormalLightTest, ConnectionsBringWhatLobesMeet) {
    const std::vector<Vec3d> leaning{tilted(50), tilted(-50), {0, 0.6, 0.8}, {0.3, -0.7, 0.6}};
    std::vector<Vec3d> texels;
    for (std::size_t i = 0; i < 64; ++i) {
        texels.push_back(leaning[(i * 7 / 3) % 4]);
    }
    for (const std::size_t which : {0u, 4u, 7u}) {
        SceneBuilder builder;
        builder.camera({-2, 2, 0}, {0, 0, 0}).image(1, 1, 5, true).depth(2);
        const std::uint32_t surface = kinds[which].make(builder);
        builder.scene.materials[surface].emission = Vec3d(0.0);
        builder.normal_map(surface, 64, 1, texels);
        builder.quad(surface, {0, 0, 0}, 1, 1);
        // The lower part of the lamp is behind the plate's horizon, seen from the leaning normals.
        builder.sphere(builder.emitter(Vec3d(1.0)), {2, 0.9, 0.5}, 2.5);
        test::expect_connections_bring_what_lobes_meet<TypeParam>(builder.scene, static_cast<double>(which));
    }
}

TYPED_TEST(ShadingNormalLightTest, ConnectionsThroughGlassBringWhatLobesMeet) {
    SceneBuilder builder;
    builder.camera({-2, 3, 0}, {0, 1, 0}).image(1, 1, 5, true).depth(2);
    const std::uint32_t glass = builder.rough_dielectric(1.5, 0.6, {0.2, 0.5, 1});
    builder.normal_map(glass, 2, 1, {tilted(40), tilted(-30)});
    builder.box(glass, {0, 0, 0}, {4, 2, 4});
    builder.sphere(builder.emitter(Vec3d(1.0)), {1, -0.2, 0.3}, 1.4);
    test::expect_connections_bring_what_lobes_meet<TypeParam>(builder.scene, 0.6);
}

// Corners with several normals, as on a mesh that is shaded round but has few triangles.
TYPED_TEST(ShadingNormalLightTest, ConnectionsOverCornersBringWhatLobesMeet) {
    Mesh roof;
    roof.vertices = {{-1, 0, -1}, {-1, 0, 1}, {1, 0, 1}, {1, 0, -1}};
    roof.triangles = {{0, 1, 2}, {0, 2, 3}};
    roof.normals = {{-1, 1, 0}, {-1, 1, 0.4f}, {1, 1, 0}, {1.5f, 1, 0.2f}};
    SceneBuilder builder;
    builder.camera({-1, 2, 0}, {0, 0, 0}).image(1, 1, 30, true).depth(2);
    builder.mesh(builder.diffuse(Vec3d(0.8)), make_scene_mesh(roof, "roof", true), {0, 0, 0}, 1).shading_normals = true;
    builder.sphere(builder.emitter(Vec3d(1.0)), {2, 0.9, 0.5}, 2.5);
    test::expect_connections_bring_what_lobes_meet<TypeParam>(builder.scene, 0);
}

}  // namespace
}  // namespace pt
