// The mask is honest: what a scene needs is in it and nothing else, and a kernel that has just that leaves the film of
// the kernel that has everything. For every feature a scene with it and one without.
#include <gtest/gtest.h>

#include "harness/render/adjoint_table.h"
#include "harness/render/renderer.h"
#include "tests/support/scenes.h"
#include "variants/integrator/depth_first.h"

namespace pt {
namespace {

using test::SceneBuilder;

constexpr std::uint32_t samples = 4;

// `asked`: what the variant asks for rather than the scene.
template <FeatureSet mask>
Film film_of(const Scene& scene, FeatureSet asked) {
    RenderSettings settings = default_settings(scene);
    settings.seed = 5;
    settings.final_bounce = contains(asked, Feature::final_bounce);
    settings.next_event = contains(asked, Feature::next_event);
    settings.mis_exponent = contains(asked, Feature::multiple_importance) ? 2 : 0;
    settings.light_sampling = light_sampling_in(asked);
    settings.near_light = 100;
    settings.light_selection = light_selection_in(asked);
    settings.one_sample = contains(asked, Feature::one_sample);
    settings.roulette_start = contains(asked, Feature::russian_roulette) ? 2 : 0;
    settings.guided_share = contains(asked, Feature::guided_walk) ? 0.75 : 0;
    settings.adjoint.paths = contains(asked, Feature::adjoint_roulette) ? 256 : 0;
    settings.sampler = asked & samplers;
    SceneBuffers<float> buffers(scene, settings);
    const LearnedAdjoint<float> learned = learned_adjoint<float>(scene, settings);
    buffers.set_adjoint(learned.cache());
    Film film(settings.width, settings.height, radiance_bound(scene, settings), samples);
    PathCounters counters;
    for (std::uint32_t pixel = 0; pixel < settings.width * settings.height; ++pixel) {
        PixelSum<Config<float, mask>> sum;
        for (std::uint32_t sample = 0; sample < samples; ++sample) {
            integrator::depth_first::trace<Config<float, mask>>(buffers.view(), film.view(), sum, pixel, sample,
                                                                nullptr, false, counters);
        }
        sum.finish(film.view(), pixel);
    }
    return film;
}

constexpr FeatureSet base = ((Feature::sphere | Feature::axis_box) | Feature::diffuse) | Feature::emitter;

// A lamp, a ball and a floor; the camera sees all of them.
struct Still {
    SceneBuilder builder;
    std::uint32_t grey = 0;

    Still() {
        grey = builder.diffuse(Vec3d(0.7, 0.6, 0.5));
        const std::uint32_t lamp = builder.emitter(Vec3d(3, 2, 1));
        builder.sphere(lamp, {0.8, 1.2, 2.5}, 0.8);
        builder.sphere(grey, {-0.4, -0.2, 2.5}, 0.9);
        builder.box(grey, {0, -0.8, 2.5}, {4, 0.2, 4});
        builder.image(16, 16, 60, false).depth(5);
    }
    SceneObject& ball() { return builder.scene.objects[1]; }
};

struct Case {
    const char* name;
    Feature feature;
    void (*add)(Still&);
    Film (*own)(const Scene&, FeatureSet);
    FeatureSet asked = no_features;
};

template <Feature feature>
Case with(const char* name, void (*add)(Still&)) {
    return {name, feature, add, &film_of<base | feature>};
}

// Asked for by the variant; `other`: what it stands on.
template <Feature feature, FeatureSet other = no_features>
Case asked_for(const char* name) {
    return {name, feature, [](Still&) {}, &film_of<(base | feature) | other>, other | feature};
}

// A case whose feature stands on another feature, which the kernel must have as well.
template <Feature feature, Feature other>
Case with(const char* name, void (*add)(Still&)) {
    return {name, feature, add, &film_of<(base | feature) | other>};
}

void make_ball(Still& still, std::uint32_t material) { still.ball().material = material; }

const Case cases[] = {
    with<Feature::ellipsoid>("ellipsoid",
                             [](Still& s) {
                                 s.builder.ellipsoid(s.grey, {0.3, 0, 2}, {0.3, 0.5, 0.4}, {10, 20, 30});
                             }),
    with<Feature::oriented_box>("oriented_box",
                                [](Still& s) {
                                    s.builder.box(s.grey, {0.3, 0, 2}, {0.3, 0.5, 0.4}, {10, 20, 30});
                                }),
    with<Feature::quad>("quad",
                        [](Still& s) {
                            s.builder.quad(s.grey, {0.3, 0, 2}, 0.6, 0.8, {40, 20, 0});
                        }),
    with<Feature::near_sphere>("near_sphere",
                               [](Still& s) {
                                   // A ground above the floor, whose place single precision holds to 4 units.
                                   s.builder.sphere(s.builder.emitter(Vec3d(0.1)), {0, -1e8 - 0.3, 2.5}, 2e8);
                               }),
    with<Feature::motion>("motion",
                          [](Still& s) {
                              s.ball().velocity = Vec3d(0.5, 0.2, 0);
                              s.builder.scene.camera.shutter_close = 1;
                          }),
    with<Feature::mirror>("mirror", [](Still& s) { make_ball(s, s.builder.mirror(Vec3d(0.9))); }),
    with<Feature::mix>("mix", [](Still& s) { make_ball(s, s.builder.mix(Vec3d(0.5), Vec3d(0.9), 0.5)); }),
    with<Feature::dielectric>("dielectric", [](Still& s) { make_ball(s, s.builder.dielectric(1.5)); }),
    with<Feature::subsurface>("subsurface", [](Still& s) { make_ball(s, s.builder.subsurface(Vec3d(4), Vec3d(0.1))); }),
    with<Feature::rough_conductor>(
        "rough_conductor", [](Still& s) { make_ball(s, s.builder.rough_conductor(Vec3d(0.9, 0.7, 0.5), 0.1)); }),
    with<Feature::multiple_scattering, Feature::rough_conductor>(
        "multiple_scattering",
        [](Still& s) { make_ball(s, s.builder.rough_conductor(Vec3d(0.9, 0.7, 0.5), 0.8, Vec3d(0.0), true)); }),
    with<Feature::rough_dielectric>("rough_dielectric",
                                    [](Still& s) {
                                        make_ball(s, s.builder.rough_dielectric(1.5, 0.3));
                                        s.builder.sphere(s.builder.emitter(Vec3d(1)), {-0.4, -0.2, 2.5}, 0.5);
                                    }),
    with<Feature::principled>("principled",
                              [](Still& s) {
                                  make_ball(s, s.builder.principled({0.9, 0.7, 0.5}, 0.25, 0.3, 0.25));
                                  s.builder.sphere(s.builder.emitter(Vec3d(1)), {-0.4, -0.2, 2.5}, 0.5);
                              }),
    with<Feature::emission>("emission", [](Still& s) { make_ball(s, s.builder.diffuse(Vec3d(0.5), Vec3d(0.3))); }),
    with<Feature::absorption, Feature::dielectric>(
        "absorption", [](Still& s) { make_ball(s, s.builder.dielectric(1.5, Vec3d(0.5, 1, 2))); }),
    with<Feature::subsurface_boundary, Feature::subsurface>(
        "subsurface_boundary", [](Still& s) { make_ball(s, s.builder.subsurface(Vec3d(4), Vec3d(0.1), 0, 1.4)); }),
    with<Feature::environment>("environment", [](Still& s) { s.builder.environment(0.5); }),
    with<Feature::environment_map>("environment_map",
                                   [](Still& s) {
                                       s.builder.environment_map(2, 1, {{0.5, 0.25, 0.125}, {2, 3, 4}});
                                   }),
    with<Feature::textures>(
        "textures",
        [](Still& s) {
            s.builder.texture(s.grey, 2, 2, {{0.9, 0.1, 0.1}, {0.1, 0.9, 0.1}, {0.1, 0.1, 0.9}, {0.5, 0.5, 0.5}});
        }),
    with<Feature::shading_normals, Feature::textures>(
        "shading_normals",
        [](Still& s) {
            s.builder.normal_map(s.grey, 2, 1, {{0.5, 0.25, 0.75}, {-0.5, 0.25, 0.75}});
        }),
    with<Feature::jitter>("jitter", [](Still& s) { s.builder.scene.camera.jitter = true; }),
    with<Feature::lens>("lens",
                        [](Still& s) {
                            s.builder.scene.camera.aperture_radius = 0.1;
                            s.builder.scene.camera.focus_distance = 2;
                        }),
    asked_for<Feature::final_bounce>("final_bounce"),
    asked_for<Feature::next_event>("next_event"),
    asked_for<Feature::multiple_importance, no_features | Feature::next_event>("multiple_importance"),
    asked_for<Feature::area_sampling, no_features | Feature::next_event>("area_sampling"),
    asked_for<Feature::projected_sampling, no_features | Feature::next_event>("projected_sampling"),
    asked_for<Feature::automatic_sampling, no_features | Feature::next_event>("automatic_sampling"),
    asked_for<Feature::power_selection, no_features | Feature::next_event>("power_selection"),
    asked_for<Feature::tree_selection, no_features | Feature::next_event>("tree_selection"),
    asked_for<Feature::one_sample, Feature::next_event | Feature::multiple_importance>("one_sample"),
    asked_for<Feature::russian_roulette>("russian_roulette"),
    asked_for<Feature::adjoint_roulette>("adjoint_roulette"),
    asked_for<Feature::philox>("philox"),
    asked_for<Feature::sobol_owen>("sobol_owen"),
    asked_for<Feature::minstd>("minstd"),
    asked_for<Feature::sobol_rotated>("sobol_rotated"),
    asked_for<Feature::pmj02>("pmj02"),
    asked_for<Feature::halton>("halton"),
    {"guided_walk", Feature::guided_walk,
     [](Still& s) { make_ball(s, s.builder.subsurface(Vec3d(4, 3, 2), Vec3d(0.1))); },
     &film_of<(base | Feature::subsurface) | Feature::guided_walk>, no_features | Feature::guided_walk},
};

// What a scene needs, with what its variant asks for.
FeatureSet needed(const Scene& scene, FeatureSet asked) { return features_of(scene) | asked; }

TEST(FeatureMask, HasWhatTheSceneNeedsAndNothingElse) {
    EXPECT_EQ(features_of(Still().builder.scene), base);
    for (const Case& c : cases) {
        Still still;
        c.add(still);
        const FeatureSet mask = needed(still.builder.scene, c.asked);
        EXPECT_TRUE(contains(mask, c.feature)) << c.name;
        const FeatureSet rest = mask & ~static_cast<FeatureSet>(c.feature);
        const bool on_another = c.feature == Feature::absorption || c.feature == Feature::subsurface_boundary ||
                                c.feature == Feature::multiple_importance ||
                                c.feature == Feature::multiple_scattering || c.feature == Feature::one_sample ||
                                c.feature == Feature::guided_walk || c.feature == Feature::shading_normals ||
                                contains(light_samplings | light_selections, c.feature);
        const FeatureSet stood_on = set_of(Feature::dielectric, Feature::subsurface, Feature::next_event,
                                           Feature::multiple_importance, Feature::rough_conductor, Feature::textures);
        EXPECT_EQ(rest & ~stood_on, base) << c.name;
        EXPECT_EQ((rest & stood_on) != 0, on_another) << c.name;
    }
}

TEST(FeatureMask, LeavesTheFilmOfAllFeatures) {
    const Still plain;
    EXPECT_EQ(film_of<base>(plain.builder.scene, no_features).hash(),
              film_of<all_features | samplings>(plain.builder.scene, no_features).hash());
    for (const Case& c : cases) {
        Still still;
        c.add(still);
        const Film own = c.own(still.builder.scene, c.asked);
        EXPECT_EQ(own.hash(), film_of<all_features | samplings>(still.builder.scene, c.asked).hash()) << c.name;
        // And the feature is to be seen: a kernel that lacks it leaves another film.
        EXPECT_NE(own.hash(), film_of<base>(still.builder.scene, no_features).hash()) << c.name;
    }
}

TEST(FeatureMask, OfTheBaseIsNeededBitByBit) {
    const Scene scene = Still().builder.scene;
    const std::string whole = film_of<base>(scene, no_features).hash();
    EXPECT_NE(whole, (film_of<base & ~static_cast<FeatureSet>(Feature::sphere)>(scene, no_features).hash()));
    EXPECT_NE(whole, (film_of<base & ~static_cast<FeatureSet>(Feature::axis_box)>(scene, no_features).hash()));
    EXPECT_NE(whole, (film_of<base & ~static_cast<FeatureSet>(Feature::diffuse)>(scene, no_features).hash()));
    EXPECT_NE(whole, (film_of<base & ~static_cast<FeatureSet>(Feature::emitter)>(scene, no_features).hash()));
}

// Whoever picks a kernel that lacks something is stopped before it runs.
TEST(FeatureMask, ThatLacksAFeatureIsRefused) {
    const Registration careless(
        {.axis = "specialisation",
         .name = "test_careless",
         .summary = "lacks everything",
         .origin = "tests",
         .backends = on_every_backend},
        {.specialisation = [](const KernelOffer&, const Variant&, Backend) { return no_features; }});
    Variant variant = Registry::instance().baseline();
    variant.set("specialisation", "test_careless");
    EXPECT_THROW((void)choose_kernel(Still().builder.scene, variant), std::logic_error);
}

}  // namespace
}  // namespace pt
