// Colours that are images (kernels/texture.h): an image of one colour leaves the film of that colour, bit for bit;
// images are looked up as their definition says, blended within their range, repeated without a seam; and each shape
// shows them upright, where the documentation says.
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "harness/render/renderer.h"
#include "harness/scene/scene_mesh.h"
#include "kernels/texture.h"
#include "tests/support/stage.h"

namespace pt {
namespace {

using test::Random;
using test::SceneBuilder;

template <class Real>
class TextureTest : public testing::Test {};
using Reals = testing::Types<float, double>;
TYPED_TEST_SUITE(TextureTest, Reals);

// What a kernel needs of a scene to look one image up.
template <class Real>
struct ImageAlone {
    std::vector<Vec3<float>> image;
    View<Vec3<float>> texels;
    ObjectTexture<Real> texture;

    ImageAlone(std::uint32_t width, std::uint32_t height, const std::vector<Vec3<float>>& values)
        : image(values), texels{image.data(), static_cast<std::uint32_t>(image.size())}, texture{} {
        texture.colour = {width, height, 0};
    }
    Vec3<Real> at(Real u, Real v) const { return image_at(*this, texture.colour, Vec2<Real>{u, v}); }
};

// Every kind of shape with the material, in view; both by a mesh of its own and by one that is shared.
void add_every_shape(SceneBuilder& builder, std::uint32_t material) {
    builder.quad(material, {0, 0, 0}, 8, 8);
    builder.sphere(material, {-1, 0.5, 0}, 1);
    builder.ellipsoid(material, {0.2, 0.5, 0}, {1, 0.8, 0.6}, {10, 20, 30});
    builder.box(material, {1.4, 0.4, 0.3}, {0.8, 0.8, 0.8});
    builder.box(material, {-0.4, 0.4, -1}, {0.5, 0.8, 0.3}, {10, 50, 20});
    builder.mesh(material, test::square_mesh(), {0, 1.5, 1.5}, 3);
    builder.mesh(material, test::square_mesh(2), {-1.5, 1, 0.5}, 1, {0, 130, 0});
    builder.mesh(material, test::square_mesh(2), {1.5, 1, 0.9}, 1, {0, 200, 0});
}

Scene room_of_shapes(const std::function<std::uint32_t(SceneBuilder&)>& make_material) {
    SceneBuilder builder;
    builder.camera({0, 1.5, -4}, {0, 0.8, 0}).image(24, 24, 55, true).depth(5).environment(0.25);
    add_every_shape(builder, make_material(builder));
    test::lamp(builder);
    return builder.scene;
}

const std::vector<std::function<std::uint32_t(SceneBuilder&)>> materials{
    [](auto& b) {
        return b.diffuse({0.75, 0.5, 0.25});
    },
    [](auto& b) {
        return b.diffuse({0.75, 0.5, 0.25}, {0.1, 0.2, 0.3});
    },
    [](auto& b) {
        return b.mirror({0.75, 0.5, 0.25});
    },
    [](auto& b) {
        return b.mix({0.75, 0.5, 0.25}, {0.9, 0.8, 0.7}, 0.4);
    },
    [](auto& b) {
        return b.rough_conductor({0.75, 0.5, 0.25}, 0.4);
    },
    [](auto& b) {
        return b.rough_conductor({0.75, 0.5, 0.25}, 0.8, Vec3d(0.0), true);
    },
};

TYPED_TEST(TextureTest, OfOneColourIsThatColour) {
    for (const auto& material : materials) {
        const Scene plain = room_of_shapes(material);
        const Scene single = room_of_shapes([&](SceneBuilder& b) {
            const std::uint32_t m = material(b);
            b.texture(m, 1, 1, {{0.75, 0.5, 0.25}});
            return m;
        });
        const Scene many = room_of_shapes([&](SceneBuilder& b) {
            const std::uint32_t m = material(b);
            b.texture(m, 5, 3, std::vector<Vec3d>(15, {0.75, 0.5, 0.25}));
            return m;
        });
        ASSERT_TRUE(contains(features_of(single), Feature::textures));
        ASSERT_FALSE(contains(features_of(plain), Feature::textures));
        for (const bool next_event : {false, true}) {
            const test::RenderOptions options{.samples = 3, .next_event = next_event, .mis_exponent = 2u};
            const std::string film = test::render<TypeParam>(plain, options).hash();
            EXPECT_EQ(test::render<TypeParam>(single, options).hash(), film);
            EXPECT_EQ(test::render<TypeParam>(many, options).hash(), film);
        }
    }
}

TYPED_TEST(TextureTest, IsBilinearBetweenTheMiddlesOfTexels) {
    const Vec3<float> a(1, 0, 0.5f), b(0, 1, 0.25f), c(0.5f, 0.25f, 0), d(0.125f, 0, 1);
    const ImageAlone<TypeParam> image(2, 2, {a, b, c, d});
    using Real = TypeParam;
    const auto mean = [](std::initializer_list<Vec3<float>> of) {
        Vec3<Real> sum(Real(0));
        for (const Vec3<float>& v : of) {
            sum += Vec3<Real>(v);
        }
        return sum / static_cast<Real>(of.size());
    };
    EXPECT_EQ(image.at(Real(0.25), Real(0.25)), Vec3<Real>(a));
    EXPECT_EQ(image.at(Real(0.75), Real(0.25)), Vec3<Real>(b));
    EXPECT_EQ(image.at(Real(0.25), Real(0.75)), Vec3<Real>(c));
    EXPECT_EQ(image.at(Real(0.75), Real(0.75)), Vec3<Real>(d));
    EXPECT_EQ(image.at(Real(0.5), Real(0.25)), mean({a, b}));
    EXPECT_EQ(image.at(Real(0.25), Real(0.5)), mean({a, c}));
    EXPECT_EQ(image.at(Real(0.5), Real(0.5)), mean({a, b, c, d}));
    // Beyond the edges it goes on with the other side.
    EXPECT_EQ(image.at(Real(0), Real(0.25)), mean({a, b}));
    EXPECT_EQ(image.at(Real(1), Real(0.25)), mean({a, b}));
    EXPECT_EQ(image.at(Real(0), Real(0)), mean({a, b, c, d}));
    EXPECT_EQ(image.at(Real(0.375), Real(0.25)), mean({a, a, a, b}));
    EXPECT_EQ(image.at(Real(0.125), Real(0.25)), mean({a, a, a, b}));
}

TYPED_TEST(TextureTest, ReproducesARampAtTheMiddlesOfTexels) {
    constexpr std::uint32_t side = 16;
    std::vector<Vec3<float>> texels;
    for (std::uint32_t i = 0; i < side * side; ++i) {
        texels.emplace_back(static_cast<float>(i % side) / 16, static_cast<float>(i / side) / 16, 0.5f);
    }
    using Real = TypeParam;
    const ImageAlone<Real> image(side, side, texels);
    for (std::uint32_t row = 0; row < side; ++row) {
        for (std::uint32_t column = 0; column < side; ++column) {
            const Real u = (static_cast<Real>(column) + Real(0.5)) / Real(side);
            const Real v = (static_cast<Real>(row) + Real(0.5)) / Real(side);
            EXPECT_EQ(image.at(u, v), Vec3<Real>(texels[row * side + column]));
            // Wherever else in the plane it is shown: these sums are exact.
            EXPECT_EQ(image.at(u - 3, v + 2), Vec3<Real>(texels[row * side + column]));
        }
    }
    // Between them it is the ramp: of sixteenths and eighths of a texel every sum and product is exact.
    for (int i = 8; i <= 120; ++i) {
        const Real u = static_cast<Real>(i) / Real(128);
        EXPECT_EQ(image.at(u, Real(0.5)).x, u - Real(1) / 32);
    }
}

TYPED_TEST(TextureTest, StaysInRangeAndHasNoSeam) {
    using Real = TypeParam;
    Random random(11);
    for (const auto& [width, height] : {std::pair{1u, 7u}, {3u, 1u}, {5u, 9u}, {64u, 2u}}) {
        std::vector<Vec3<float>> texels;
        for (std::uint32_t i = 0; i < width * height; ++i) {
            const auto value = [&] {
                const double draw = random.uniform();
                return draw < 0.25 ? 0.0f : draw < 0.5 ? 1.0f : static_cast<float>(random.uniform());
            };
            texels.emplace_back(value(), value(), value());
        }
        const ImageAlone<Real> image(width, height, texels);
        const auto expect_in_range = [&](Real u, Real v) {
            const Vec3<Real> colour = image.at(u, v);
            for (int channel = 0; channel < 3; ++channel) {
                ASSERT_TRUE(colour[channel] >= Real(0) && colour[channel] <= Real(1)) << u << ", " << v;
            }
        };
        for (int i = 0; i < 20000; ++i) {
            expect_in_range(static_cast<Real>(random.uniform(-3, 3)), static_cast<Real>(random.uniform(-3, 3)));
        }
        // A step across the edge changes no more than a step of as many texels within the image.
        const Real step = std::numeric_limits<Real>::epsilon();
        for (int i = 0; i < 200; ++i) {
            const auto v = static_cast<Real>(random.uniform());
            for (const Real edge : {Real(0), Real(1), Real(-1), Real(5)}) {
                const Real before = std::nextafter(edge, Real(-10)), after = std::nextafter(edge, Real(10));
                for (const Real u : {before, edge, after}) {
                    expect_in_range(u, v);
                    const Vec3<Real> off = image.at(u, v) - image.at(edge, v);
                    const Real most = 16 * step * static_cast<Real>(width);
                    EXPECT_LE(std::max({std::abs(off.x), std::abs(off.y), std::abs(off.z)}), most) << u << ", " << v;
                }
            }
        }
        for (const Real far : {Real(1e6), Real(-1e6), Real(-1e-30), Real(1e-30)}) {
            expect_in_range(far, far);
        }
    }
}

// The albedo of a texel. A surface of albedo a alone in an even light of 1 gives every path the radiance a: a film of
// it is its image.
Vec3d texel_of_four(std::uint32_t column, std::uint32_t row) {
    return {(1 + column) / 8.0, (1 + row) / 8.0, (column + 4 * row) / 16.0};
}

std::vector<Vec3d> four_by_four() {
    std::vector<Vec3d> texels;
    for (std::uint32_t i = 0; i < 16; ++i) {
        texels.push_back(texel_of_four(i % 4, i / 4));
    }
    return texels;
}

// The image fills the frame: pixel for texel. Up to the rounding of a place on the surface, a few texels' 2^-24 at
// most, and of the film's quanta.
template <class Real>
void expect_whole_image(const SceneBuilder& builder, const std::string& what) {
    const Film film = test::render<Real>(builder.scene, {});
    for (std::uint32_t row = 0; row < 4; ++row) {
        for (std::uint32_t column = 0; column < 4; ++column) {
            const Vec3d seen = film.pixel(row * 4 + column), expected = texel_of_four(column, 3 - row);
            for (int channel = 0; channel < 3; ++channel) {
                EXPECT_NEAR(seen[channel], expected[channel], 2e-6) << what << " " << column << ", " << row;
            }
        }
    }
}

struct Side {
    const char* name;
    Vec3d from, up;
};
const Side sides[] = {{"+x", {1, 0, 0}, {0, 1, 0}},  {"-x", {-1, 0, 0}, {0, 1, 0}}, {"+y", {0, 1, 0}, {0, 0, -1}},
                      {"-y", {0, -1, 0}, {0, 0, 1}}, {"+z", {0, 0, 1}, {0, 1, 0}},  {"-z", {0, 0, -1}, {0, 1, 0}}};

TYPED_TEST(TextureTest, IsUprightOnEverySideOfABox) {
    // Turned by a rotation that makes an axis box of it again, by one that does not, and stretched.
    for (const auto& [turn, scale] : {std::pair{Vec3d(0, 0, 0), Vec3d(2, 2, 2)},
                                      {Vec3d(90, 0, 180), Vec3d(2, 2, 2)},
                                      {Vec3d(20, 35, 50), Vec3d(2, 2, 2)}}) {
        const Rotation rotation = rotation_of(turn);
        const auto turned = [&](const Vec3d& v) {
            return rotation.column[0] * v.x + rotation.column[1] * v.y + rotation.column[2] * v.z;
        };
        for (const Side& side : sides) {
            SceneBuilder builder;
            const Vec3d centre(3, -2, 5);
            builder.camera(centre + turned(side.from) * 2.0, centre, turned(side.up)).image(4, 4, 90, false);
            builder.environment(1).depth(2);
            const std::uint32_t material = builder.diffuse(Vec3d(1.0));
            builder.texture(material, 4, 4, four_by_four());
            builder.box(material, centre, scale, turn);
            expect_whole_image<TypeParam>(builder, side.name);
        }
    }
}

// The face of a box far thinner than it is wide is told by the normal.
TYPED_TEST(TextureTest, IsWholeOnAThinPlate) {
    for (const Vec3d& turn : {Vec3d(0, 0, 0), Vec3d(0, 30, 0)}) {
        SceneBuilder builder;
        builder.camera({0, 1 + 5e-7, 0}, {0, 0, 0}, -rotation_of(turn).column[2]).image(4, 4, 90, false);
        builder.environment(1).depth(2);
        const std::uint32_t material = builder.diffuse(Vec3d(1.0));
        builder.texture(material, 4, 4, four_by_four());
        builder.box(material, {0, 0, 0}, {2, 1e-6, 2}, turn);
        expect_whole_image<TypeParam>(builder, "plate");
    }
}

TYPED_TEST(TextureTest, IsUprightOnQuadsAndMeshes) {
    SceneBuilder quad;
    quad.camera({1, 3, 2}, {1, 2, 2}, {0, 0, -1}).image(4, 4, 90, false).environment(1).depth(2);
    const std::uint32_t material = quad.diffuse(Vec3d(1.0));
    quad.texture(material, 4, 4, four_by_four());
    quad.quad(material, {1, 2, 2}, 2, 2);
    expect_whole_image<TypeParam>(quad, "quad");
    for (const bool is_shared : {false, true}) {
        SceneBuilder mesh;
        mesh.camera({1, 2, 3}, {1, 2, 2}).image(4, 4, 90, false).environment(1).depth(2);
        const std::uint32_t shown = mesh.diffuse(Vec3d(1.0));
        mesh.texture(shown, 4, 4, four_by_four());
        const auto upright = test::square_mesh();
        mesh.mesh(shown, upright, {1, 2, 2}, 2);
        if (is_shared) {
            mesh.mesh(shown, upright, {1, 2, 200}, 2);
        }
        expect_whole_image<TypeParam>(mesh, is_shared ? "shared mesh" : "mesh");
    }
}

// Rays meet shapes in motion, turned and stretched; the oracle is the definition in double.
TYPED_TEST(TextureTest, LiesOnASphereByLatitudeAndLongitude) {
    using Real = TypeParam;
    using Kernel = Config<Real, all_features | samplers | traversals>;
    SceneBuilder builder;
    builder.camera({0, 0.5, 4}, {0, 0, 0}).image(48, 48, 40, true);
    const std::uint32_t material = builder.diffuse(Vec3d(1.0));
    builder.texture(material, 4, 4, four_by_four());
    const Vec3d turn(20, 40, 60), scale(2, 1.5, 1);
    builder.ellipsoid(material, {0.1, 0.2, 0.3}, scale, turn);
    const Rotation rotation = rotation_of(turn);
    const test::Stages<Real> stages(builder.scene);
    int met = 0;
    for (std::uint32_t pixel = 0; pixel < 48 * 48; ++pixel) {
        const Path<Real> path = stages.generate(pixel, 0);
        const Hit<Real> hit = stages.intersect(path);
        if (!hit.side.exists()) {
            continue;
        }
        const SurfacePoint<Real> point = stages.surface(ray_of(path), hit);
        const Vec2<Real> at = texture_coordinates_at<Kernel>(stages.view(), stages.view().object_textures[0],
                                                             ray_of(path), hit, point.position, point.normal);
        const Vec3d world = Vec3d(point.position) + builder.scene.camera.eye - builder.scene.objects[0].translate;
        const Vec3d p(dot(rotation.column[0], world) / scale.x, dot(rotation.column[1], world) / scale.y,
                      dot(rotation.column[2], world) / scale.z);
        // In the middle of the image +z, a quarter to the right of it +x.
        const double u = 0.5 + std::atan2(p.x, p.z) / (2 * pi<double>), v = 0.5 + std::asin(2 * p.y) / pi<double>;
        const double off = std::abs(static_cast<double>(at.x) - u);
        EXPECT_LT(std::min(off, 1 - off), sizeof(Real) == 4 ? 2e-5 : 1e-12);  // meridians meet at the poles
        EXPECT_NEAR(static_cast<double>(at.y), v, sizeof(Real) == 4 ? 2e-5 : 1e-12);
        ++met;
    }
    EXPECT_GT(met, 500);
}

// Coordinates that are linear in the place are that function of the place, whatever the triangle.
TYPED_TEST(TextureTest, IsLinearOverATriangle) {
    using Real = TypeParam;
    using Kernel = Config<Real, all_features | samplers | traversals>;
    Random random(3);
    int met = 0;
    for (int i = 0; i < 200; ++i) {
        Mesh mesh;
        std::array<std::array<float, 2>, 3> corners;
        const auto coordinate = [](const std::array<float, 3>& p) { return 0.5 * p[0] - 0.25 * p[1] + 0.125; };
        for (auto& corner : corners) {
            mesh.vertices.push_back({static_cast<float>(random.uniform(-1, 1)),
                                     static_cast<float>(random.uniform(-1, 1)),
                                     static_cast<float>(random.uniform(-0.25, 0.25))});
            corner = {static_cast<float>(coordinate(mesh.vertices.back())), 1 - mesh.vertices.back()[0]};
        }
        mesh.triangles = {{0, 1, 2}};
        mesh.coordinates = {corners};
        SceneBuilder builder;
        builder.camera({0.1, 0.2, -3}, {0, 0, 0}).image(8, 8, 40, true);
        const std::uint32_t material = builder.diffuse(Vec3d(1.0));
        builder.texture(material, 1, 1, {Vec3d(1.0)});
        builder.mesh(material, make_scene_mesh(mesh, "triangle"), {0, 0, 0}, 1);
        const test::Stages<Real> stages(builder.scene);
        for (std::uint32_t pixel = 0; pixel < 64; ++pixel) {
            const Path<Real> path = stages.generate(pixel, 0);
            const Hit<Real> hit = stages.intersect(path);
            if (!hit.side.exists()) {
                continue;
            }
            const SurfacePoint<Real> point = stages.surface(ray_of(path), hit);
            const Vec2<Real> at = texture_coordinates_at<Kernel>(stages.view(), stages.view().object_textures[0],
                                                                 ray_of(path), hit, point.position, point.normal);
            const Vec3d p = Vec3d(path.origin + path.direction * hit.t) + builder.scene.camera.eye;
            // Corners are single precision numbers; places a few units from the eye, to their roundings. Of needles
            // seen from their edge the weights know no more than that over their width.
            EXPECT_NEAR(static_cast<double>(at.x), 0.5 * p.x - 0.25 * p.y + 0.125, 4e-6);
            EXPECT_NEAR(static_cast<double>(at.y), 1 - p.x, 4e-6);
            ++met;
        }
    }
    EXPECT_GT(met, 500);
}

// What an object shows moves with it.
TYPED_TEST(TextureTest, MovesWithItsObject) {
    SceneBuilder builder;
    builder.camera({1, 3, 2}, {1, 2, 2}, {0, 0, -1}).image(4, 4, 90, false).environment(1).depth(2);
    const std::uint32_t material = builder.diffuse(Vec3d(1.0));
    builder.texture(material, 4, 4, four_by_four());
    builder.quad(material, {0, 2, 0}, 2, 2).velocity = Vec3d(0.5, 0, 1);
    builder.scene.camera.shutter_open = builder.scene.camera.shutter_close = 2;
    expect_whole_image<TypeParam>(builder, "moving quad");
}

// A closed room of white walls that shows any image of white keeps all of its own light: emission times the number of
// segments. And of grey texels it keeps the series of their colour (tests/image/furnace_test.cpp).
TYPED_TEST(TextureTest, WhiteFurnaceKeepsItsLight) {
    SceneBuilder builder;
    builder.camera({0.25, 0.125, -0.5}, {0.3, -0.2, 1}).image(4, 4, 100, true).depth(6);
    const std::uint32_t white = builder.diffuse(Vec3d(1.0), Vec3d(0.25));
    builder.texture(white, 3, 2, std::vector<Vec3d>(6, Vec3d(1.0)));
    builder.sphere(white, {0, 0, 0}, 4);
    const Film film = test::render<TypeParam>(builder.scene, {.samples = 4});
    for (std::size_t pixel = 0; pixel < 16; ++pixel) {
        EXPECT_EQ(film.pixel(pixel), Vec3d(1.5));
    }
}

// Every integrator, accelerator and specialisation that the program has for the scene leaves one film.
TEST(TextureFilm, IsTheSameByEveryChoice) {
    SceneBuilder builder;
    builder.camera({0, 1.5, -4}, {0, 0.8, 0}).image(24, 24, 55, true).depth(5).environment(0.25);
    const std::uint32_t tiles = builder.diffuse(Vec3d(1.0));
    builder.texture(tiles, 4, 4, four_by_four());
    const std::uint32_t metal = builder.rough_conductor(Vec3d(1.0), 0.4);
    builder.texture(metal, 2, 2, {{0.9, 0.1, 0.1}, {0.1, 0.9, 0.1}, {0.1, 0.1, 0.9}, {0.5, 0.5, 0.5}});
    builder.quad(tiles, {0, 0, 0}, 8, 8);
    builder.sphere(metal, {-1, 0.5, 0}, 1);
    builder.box(tiles, {1.4, 0.4, 0.3}, {0.8, 0.8, 0.8});
    test::lamp(builder);
    Scene with_mesh = builder.scene;
    {
        SceneBuilder more = builder;
        more.mesh(tiles, test::square_mesh(), {0, 1.5, 1.5}, 3);
        with_mesh = more.scene;
    }
    const test::RenderOptions options{.samples = 2};
    int compared = 0;
    for (const Scene& scene : {builder.scene, with_mesh}) {
        const std::string film = test::render_variant(scene, options).hash();
        EXPECT_EQ(test::render<float>(scene, options).hash(), film);
        for (const char* const axis : {"integrator", "accelerator", "layout", "compaction", "sorting", "levels"}) {
            for (const Choice* choice : Registry::instance().choices(axis)) {
                Variant variant = Registry::instance().baseline();
                variant.set(axis, std::string(choice->descriptor.name));
                if (why_not_applicable(variant, features_of(scene)).empty()) {
                    EXPECT_EQ(test::render_variant(scene, options, axis, std::string(choice->descriptor.name)).hash(),
                              film)
                        << axis << "=" << choice->descriptor.name;
                    ++compared;
                }
            }
        }
    }
    EXPECT_GT(compared, 20);
}

}  // namespace
}  // namespace pt
