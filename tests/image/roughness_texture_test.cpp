// Roughnesses that are images (kernels/texture.h): an image of one number leaves the film of that roughness, bit for
// bit; a ramp has at each point the roughness that its definition says; and where it changes from place to place,
// connections still bring what lobes meet.
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "harness/render/renderer.h"
#include "harness/scene/scene_mesh.h"
#include "kernels/shade.h"
#include "tests/support/connections.h"
#include "tests/support/stage.h"

namespace pt {
namespace {

using test::RenderOptions;
using test::SceneBuilder;

template <class Real>
class RoughnessTextureTest : public testing::Test {};
using Reals = testing::Types<float, double>;
TYPED_TEST_SUITE(RoughnessTextureTest, Reals);

// Texels are single precision numbers: so is the roughness that an image of it is held to.
double in_single(double roughness) { return static_cast<double>(static_cast<float>(roughness)); }

using MakeMaterial = std::function<std::uint32_t(SceneBuilder&)>;

// Bodies of the material; with `is_metal` also what has no inside.
Scene room_of(const MakeMaterial& make_material, bool is_metal) {
    SceneBuilder builder;
    builder.camera({0, 1.5, -4}, {0, 0.8, 0}).image(20, 20, 55, true).depth(6).environment(0.25);
    builder.quad(builder.diffuse({0.75, 0.5, 0.25}), {0, -0.25, 0}, 8, 8);
    const std::uint32_t material = make_material(builder);
    builder.sphere(material, {-1, 0.5, 0}, 1);
    builder.ellipsoid(material, {0.2, 0.5, 0}, {1, 0.8, 0.6}, {10, 20, 30});
    builder.box(material, {1.4, 0.4, 0.3}, {0.8, 0.8, 0.8});
    builder.box(material, {-0.4, 0.4, -1}, {0.5, 0.8, 0.3}, {10, 50, 20});
    if (is_metal) {
        builder.quad(material, {0, 0, 2}, 4, 3, {-60, 0, 0});
        builder.mesh(material, test::square_mesh(2), {0, 1.5, 1.5}, 3);
        builder.mesh(material, test::square_mesh(2), {-1.5, 1, 0.5}, 1, {0, 130, 0});
    }
    test::lamp(builder);
    return builder.scene;
}

struct Kind {
    const char* name;
    bool is_metal;
    double roughness;
    MakeMaterial make;
};
const std::vector<Kind> kinds{
    {"conductor", true, 0.4,
     [](auto& b) {
         return b.rough_conductor({0.75, 0.5, 0.25}, in_single(0.4));
     }},
    {"smooth conductor", true, 0.05, [](auto& b) { return b.rough_conductor(Vec3d(0.9), in_single(0.05)); }},
    {"mirror", true, 0, [](auto& b) { return b.rough_conductor(Vec3d(0.9), 0); }},
    {"glowing conductor", true, 1,
     [](auto& b) {
         return b.rough_conductor(Vec3d(0.9), 1, {0.5, 0.25, 0});
     }},
    {"conductor of multiple scattering", true, 0.8,
     [](auto& b) {
         return b.rough_conductor({0.75, 0.5, 0.25}, in_single(0.8), Vec3d(0.0), true);
     }},
    {"principled surface", true, 0.3,
     [](auto& b) {
         return b.principled({0.75, 0.5, 0.25}, 0.25, in_single(0.3));
     }},
    {"lacquer", true, 0,
     [](auto& b) {
         return b.principled({0.75, 0.5, 0.25}, 0, 0);
     }},
    {"principled glass", false, 0.4,
     [](auto& b) {
         return b.principled({0.75, 0.5, 0.25}, 0, in_single(0.4), 0.75);
     }},
    {"glass", false, 0.3,
     [](auto& b) {
         return b.rough_dielectric(1.5, in_single(0.3), {0.2, 0.5, 1});
     }},
    {"smooth glass", false, 0, [](auto& b) { return b.rough_dielectric(1.5, 0); }},
    {"glass of index 1", false, 0.7,
     [](auto& b) {
         return b.rough_dielectric(1, in_single(0.7), {0.2, 0.5, 1});
     }},
};

Scene with_image(const Kind& kind, std::uint32_t width, std::uint32_t height) {
    const std::vector<double> texels(std::size_t{width} * height, kind.roughness);
    return room_of(
        [&](SceneBuilder& b) {
            const std::uint32_t material = kind.make(b);
            b.roughness_texture(material, width, height, texels);
            return material;
        },
        kind.is_metal);
}

const RenderOptions estimators[] = {
    {.samples = 3},
    {.samples = 3, .final_bounce = true},
    {.samples = 3, .next_event = true},
    {.samples = 3, .next_event = true, .mis_exponent = 1},
    {.samples = 3, .next_event = true, .mis_exponent = 2},
    {.samples = 3, .next_event = true, .mis_exponent = 2, .one_sample = true},
    {.samples = 3, .roulette_start = 2},
};

TYPED_TEST(RoughnessTextureTest, OfOneNumberIsThatRoughness) {
    for (const Kind& kind : kinds) {
        const Scene plain = room_of(kind.make, kind.is_metal);
        const Scene single = with_image(kind, 1, 1), many = with_image(kind, 5, 3);
        ASSERT_TRUE(contains(features_of(single), Feature::textures));
        ASSERT_FALSE(contains(features_of(plain), Feature::textures));
        for (const RenderOptions& options : estimators) {
            const std::string film = test::render<TypeParam>(plain, options).hash();
            EXPECT_EQ(test::render<TypeParam>(single, options).hash(), film) << kind.name;
            EXPECT_EQ(test::render<TypeParam>(many, options).hash(), film) << kind.name;
        }
    }
}

// Beside a colour that is an image too, whichever is the larger.
TYPED_TEST(RoughnessTextureTest, GoesWithAnImageOfColours) {
    const std::vector<Vec3d> colours{{0.9, 0.1, 0.1}, {0.1, 0.9, 0.1}, {0.1, 0.1, 0.9}, {0.5, 0.5, 0.5}};
    const auto coloured = [&](std::uint32_t width) {
        return room_of(
            [&](SceneBuilder& b) {
                const std::uint32_t metal = b.rough_conductor(Vec3d(1.0), in_single(0.4));
                b.texture(metal, 2, 2, colours);
                if (width != 0) {
                    b.roughness_texture(metal, width, 1, std::vector<double>(width, 0.4));
                }
                return metal;
            },
            true);
    };
    const RenderOptions options{.samples = 3, .next_event = true, .mis_exponent = 2};
    const std::string film = test::render<TypeParam>(coloured(0), options).hash();
    EXPECT_EQ(test::render<TypeParam>(coloured(1), options).hash(), film);
    EXPECT_EQ(test::render<TypeParam>(coloured(9), options).hash(), film);
}

// Every way that the program has to render and to connect is tried.
TEST(RoughnessTextureFilm, OfOneNumberIsThatRoughnessByEveryChoice) {
    const auto film_of = [](const Scene& scene, const Variant& variant) {
        RenderRequest request;
        request.variant = variant;
        request.settings = default_settings(scene);
        request.samples = 2;
        return pt::render(scene, request).film.hash();
    };
    const Registry& registry = Registry::instance();
    int compared = 0;
    for (const std::size_t which : {0u, 4u, 5u}) {
        const Kind& kind = kinds[which];
        const Scene plain = room_of(kind.make, kind.is_metal), image = with_image(kind, 1, 1);
        for (const Choice* light : registry.choices("direct_light")) {
            for (const char* const axis :
                 {"integrator", "accelerator", "layout", "compaction", "sorting", "precision", "specialisation"}) {
                for (const Choice* choice : registry.choices(axis)) {
                    Variant variant = registry.baseline();
                    variant.set("direct_light", std::string(light->descriptor.name));
                    variant.set(axis, std::string(choice->descriptor.name));
                    if (why_not_applicable(variant, features_of(image)).empty()) {
                        EXPECT_EQ(film_of(image, variant), film_of(plain, variant))
                            << kind.name << " direct_light=" << light->descriptor.name << " " << axis << "="
                            << choice->descriptor.name;
                        ++compared;
                    }
                }
            }
        }
    }
    EXPECT_GT(compared, 200);
}

// Over a quad that fills the frame, u from 0 to 1 from left to right: between the middles of two texels the roughness
// is linear, and beyond them it goes back to the other side's.
TYPED_TEST(RoughnessTextureTest, OfTwoTexelsIsARamp) {
    using Real = TypeParam;
    using Kernel = Config<Real, all_features | samplers | traversals>;
    constexpr double low = 0.125, high = 0.875;
    const std::vector<MakeMaterial> makes{[](auto& b) { return b.rough_conductor(Vec3d(1.0), 0.3); },
                                          [](auto& b) { return b.rough_dielectric(1.5, 0.3); }};
    for (const MakeMaterial& make : makes) {
        SceneBuilder builder;
        builder.camera({1, 3, 2}, {1, 2, 2}, {0, 0, -1}).image(32, 32, 90, true);
        const std::uint32_t material = make(builder);
        builder.roughness_texture(material, 2, 1, {low, high});
        builder.box(material, {1, 1, 2}, {2, 2, 2});
        const test::Stages<Real> stages(builder.scene);
        int met = 0;
        for (std::uint32_t pixel = 0; pixel < 32 * 32; ++pixel) {
            const Path<Real> path = stages.generate(pixel, 0);
            const Hit<Real> hit = stages.intersect(path);
            if (!hit.side.exists()) {
                continue;
            }
            const SurfacePoint<Real> point = stages.surface(ray_of(path), hit);
            const VertexOf<Kernel> vertex{point.position, point.normal, hit.side.object(), false, 0,
                                          hit.side,       hit.primitive};
            const Real alpha = facet_width<Kernel>(stages.view(), path, vertex, Real(0));
            const double u = (static_cast<double>(point.position.x) + builder.scene.camera.eye.x) / 2;
            const double off = std::abs(u - 0.25);
            const double roughness = low + (high - low) * 2 * std::min(off, 1 - off);
            // A place has a few roundings of 2^-24, and the width grows by 3 over the image's.
            EXPECT_NEAR(static_cast<double>(alpha), roughness * roughness, sizeof(Real) == 4 ? 2e-6 : 1e-12) << u;
            ++met;
        }
        EXPECT_GT(met, 1000);
    }
}

// Where four texels of one number lie around a point, the film is that number's, and of the other number elsewhere.
TYPED_TEST(RoughnessTextureTest, IsThatOfTheTexelsAround) {
    const auto plate = [](const std::function<void(SceneBuilder&, std::uint32_t)>& roughen) {
        SceneBuilder builder;
        builder.camera({1, 3, 2}, {1, 2, 2}, {0, 0, -1}).image(16, 16, 90, false).environment(0.25).depth(3);
        const std::uint32_t metal = builder.rough_conductor({0.9, 0.6, 0.3}, 0);
        roughen(builder, metal);
        builder.quad(metal, {1, 2, 2}, 2, 2);
        builder.sphere(builder.emitter({4, 5, 6}), {1.5, 4.5, 2}, 1.5);
        return builder.scene;
    };
    const auto even = [&](double roughness) {
        return plate([=](auto& b, std::uint32_t m) { b.scene.materials[m].roughness = roughness; });
    };
    const Scene halves = plate([](auto& b, std::uint32_t m) {
        b.roughness_texture(m, 8, 1, {0.25, 0.25, 0.25, 0.25, 0.75, 0.75, 0.75, 0.75});
    });
    for (const RenderOptions& options : estimators) {
        const Film film = test::render<TypeParam>(halves, options);
        const Film left = test::render<TypeParam>(even(0.25), options);
        const Film right = test::render<TypeParam>(even(0.75), options);
        EXPECT_NE(left.hash(), right.hash());
        for (std::size_t row = 0; row < 16; ++row) {
            for (std::size_t column = 1; column < 7; ++column) {
                EXPECT_EQ(film.pixel(16 * row + column), left.pixel(16 * row + column));
                EXPECT_EQ(film.pixel(16 * row + 15 - column), right.pixel(16 * row + 15 - column));
            }
        }
    }
}

// In an even light a white surface keeps, in the middle between 1/4 and 3/4, what one of roughness 1/2 keeps.
TYPED_TEST(RoughnessTextureTest, AnEvenLightIsKeptAsByTheRoughnessThere) {
    for (const bool multiple : {false, true}) {
        const auto plate = [&](bool has_image) {
            SceneBuilder builder;
            builder.camera({0, 3, 0}, {0, 0, 0}, {0, 0, 1}).image(1, 1, 1e-3, false).depth(2).environment(0.5);
            const std::uint32_t white = builder.rough_conductor(Vec3d(1.0), 0.5, Vec3d(0.0), multiple);
            if (has_image) {
                builder.roughness_texture(white, 2, 2, {0.25, 0.75, 0.25, 0.75});
            }
            builder.quad(white, {0, 0, 0}, 1, 1);
            return builder.scene;
        };
        const RenderOptions options{.samples = 1 << 10};
        const Film kept = test::render<TypeParam>(plate(false), options);
        EXPECT_EQ(test::render<TypeParam>(plate(true), options).sums(), kept.sums());
        EXPECT_LE(kept.pixel(0).y, multiple ? 0.505 : 0.5);
        EXPECT_GT(kept.pixel(0).y, 0.45);
    }
}

// Stripes that a pixel sees a dozen of, on both sides of the width from which lobes are connected: connections and what
// lobes meet have one density, that of the place.
std::vector<double> stripes(double first, double second) {
    std::vector<double> texels;
    for (int i = 0; i < 256; ++i) {
        texels.push_back(i % 2 == 0 ? first : second);
    }
    return texels;
}

TYPED_TEST(RoughnessTextureTest, ConnectionsBringWhatLobesMeet) {
    for (const auto& [first, second] : {std::pair{0.3, 0.8}, {0.05, 0.4}}) {
        SceneBuilder builder;
        builder.camera({-2, 2, 0}, {0, 0, 0}).image(1, 1, 5, true).depth(2);
        const std::uint32_t metal = builder.rough_conductor({0.9, 0.6, 0.3}, 1);
        builder.roughness_texture(metal, 256, 1, stripes(first, second));
        builder.quad(metal, {0, 0, 0}, 4, 4);
        builder.sphere(builder.emitter(Vec3d(1.0)), {2, 2.3, 0.5}, 2.5);
        test::expect_connections_bring_what_lobes_meet<TypeParam>(builder.scene, first);
    }
}

TYPED_TEST(RoughnessTextureTest, ConnectionsThroughTheSurfaceBringWhatLobesMeet) {
    SceneBuilder builder;
    builder.camera({-2, 3, 0}, {0, 1, 0}).image(1, 1, 5, true).depth(2);
    const std::uint32_t glass = builder.rough_dielectric(1.5, 1, {0.2, 0.5, 1});
    builder.roughness_texture(glass, 256, 1, stripes(0.4, 0.9));
    builder.box(glass, {0, 0, 0}, {4, 2, 4});
    builder.sphere(builder.emitter(Vec3d(1.0)), {1, -0.2, 0.3}, 1.4);
    test::expect_connections_bring_what_lobes_meet<TypeParam>(builder.scene, 0.4);
}

}  // namespace
}  // namespace pt
