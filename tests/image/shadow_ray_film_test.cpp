// Films of connections that look for a lamp's drawn point alone (kernels/line_of_sight.h) are, bit for bit, those of
// connections that ask for the closest hit: here the program's kernels, against one of this file that asks.
#include "variants/integrator/depth_first.h"

#include <functional>
#include <numeric>
#include <string>

#include <gtest/gtest.h>

#include "harness/render/renderer.h"
#include "harness/scene/places.h"

namespace pt {
namespace {

constexpr FeatureSet features =
    shape_features | light_samplings |
    set_of(Feature::diffuse, Feature::emitter, Feature::mirror, Feature::emission, Feature::environment,
           Feature::jitter, Feature::next_event, Feature::multiple_importance);
using LooksForPoints = Config<float, features, RunTimeAccelerator>;
struct AsksForClosestHits : LooksForPoints {};

}  // namespace

template <>
inline constexpr bool has_lines_of_sight<AsksForClosestHits> = false;
static_assert(has_lines_of_sight<LooksForPoints>);

namespace {

RenderRequest request_for(const std::string& direct_light, const std::string& light_sampling) {
    RenderRequest request;
    request.variant = Registry::instance().baseline();
    request.variant.set("integrator", "depth_first");
    request.variant.set("arithmetic", "exact");
    request.variant.set("accelerator", "bvh4");
    request.variant.set("direct_light", direct_light);
    request.variant.set("light_sampling", light_sampling);
    request.samples = 16;
    return request;
}

// Renders as pt::render does, by this file's kernel. Connections are counted.
Film film_of_closest_hits(const Scene& scene, const RenderRequest& request, PathCounters& counters) {
    const KernelChoice kernel = choose_kernel(scene, request.variant);
    EXPECT_TRUE(is_superset(features, kernel.needed)) << scene.name;
    const RenderSettings settings = settings_for(request, kernel);
    const SceneBuffers<float> buffers(scene, settings, Acceleration::of(request.variant, Backend::cpu));
    Film film(settings.width, settings.height, radiance_bound(scene, settings), request.samples);
    for (std::uint32_t pixel = 0; pixel < settings.width * settings.height; ++pixel) {
        PixelSum<AsksForClosestHits> sum;
        for (std::uint32_t i = 0; i < request.samples; ++i) {
            integrator::depth_first::trace<AsksForClosestHits>(buffers.view(), film.view(), sum, pixel, i, nullptr,
                                                               false, counters);
        }
        sum.finish(film.view(), pixel);
    }
    return film;
}

// How many channels of pixels differ between two films.
std::size_t differing(const Film& a, const Film& b) {
    EXPECT_EQ(a.sums().size(), b.sums().size());
    return static_cast<std::size_t>(std::inner_product(a.sums().begin(), a.sums().end(), b.sums().begin(), 0,
                                                       std::plus<>(), std::not_equal_to<>()));
}

void expect_same_film(const Scene& scene, const std::string& direct_light, const std::string& light_sampling,
                      std::uint32_t side = 32, std::uint32_t samples = 16) {
    const std::string what = scene.name + " " + direct_light + " " + light_sampling;
    RenderRequest request = request_for(direct_light, light_sampling);
    request.samples = samples;
    request.settings = default_settings(scene);
    request.settings.width = request.settings.height = side;
    PathCounters counters;
    const Film asked = film_of_closest_hits(scene, request, counters);
    EXPECT_GT(counters.connections, 10000u) << what;
    // With the walls of a room known as such, where the scene has them, and without.
    for (const char* specialisation : {"features", "generic"}) {
        request.variant.set("specialisation", specialisation);
        const RenderResult looked = render(scene, request);
        EXPECT_EQ(looked.work.connections, counters.connections) << what << " " << specialisation;
        EXPECT_EQ(differing(looked.film, asked), 0u) << what << " " << specialisation;
    }
}

class ShadowRayFilmTest : public testing::TestWithParam<const char*> {};

TEST_P(ShadowRayFilmTest, IsThatOfTheClosestHit) {
    const Scene scene = find_scene(GetParam());
    for (const char* direct_light : {"nee", "nee_mis"}) {
        for (const char* light_sampling : {"area", "projected", "auto"}) {
            expect_same_film(scene, direct_light, light_sampling);
        }
    }
}

// Unjittered: paths begin in corners, in the very planes of two walls.
INSTANTIATE_TEST_SUITE_P(Scenes, ShadowRayFilmTest,
                         testing::Values("cornell_open", "cornell_closed", "cornell_open_unjittered",
                                         "cornell_closed_unjittered", "many_lights", "small_light",
                                         "meshes/icosphere_room"));

// Among so many rays a few pass the lamp by that they were drawn to.
TEST(ShadowRayFilmOfEdgesTest, IsThatOfTheClosestHit) {
    for (const char* light_sampling : {"area", "projected", "auto"}) {
        expect_same_film(find_scene("small_light"), "nee", light_sampling, 128, 64);
    }
}

}  // namespace
}  // namespace pt
