// The variance of a pixel's mean from the film's sums at stops: exact where it is known, the textbook's from single
// samples, right in the mean from batches of any size, and nothing that the film's bits would notice.
#include <numeric>
#include <stdexcept>

#include <gtest/gtest.h>

#include "harness/render/pixel_variance.h"
#include "harness/render/renderer.h"
#include "tests/support/scenes.h"

namespace pt {
namespace {

using test::SceneBuilder;

struct WithVariance {
    PixelVariance variance;
    Film film;
};

RenderRequest variance_request(const Scene& scene, std::uint32_t samples, const std::string& integrator) {
    RenderRequest request;
    request.variant = Registry::instance().baseline();
    request.variant.set("integrator", integrator);
    request.settings = default_settings(scene);
    request.samples = samples;
    return request;
}

WithVariance render_with_variance(const Scene& scene, std::uint32_t samples, std::uint32_t batches,
                                  const std::string& integrator = "depth_first") {
    PixelVariance variance;
    RenderRequest request = variance_request(scene, samples, integrator);
    request.checkpoints = variance_stops(samples, batches);
    request.on_checkpoint = [&](const Checkpoint& checkpoint) { variance.add(checkpoint.film); };
    Film film = render(scene, request).film;
    return {std::move(variance), std::move(film)};
}

TEST(PixelVarianceTest, StopsCoverTheSamples) {
    EXPECT_EQ(variance_stops(1), std::vector<std::uint32_t>{1});
    EXPECT_EQ(variance_stops(5), (std::vector<std::uint32_t>{1, 2, 3, 4, 5}));
    EXPECT_EQ(variance_stops(10, 4), (std::vector<std::uint32_t>{2, 5, 7, 10}));
    for (const std::uint32_t samples : {255u, 256u, 257u, 1000u, 100000000u}) {
        const std::vector<std::uint32_t> stops = variance_stops(samples);
        EXPECT_EQ(stops.size(), std::min(samples, most_variance_batches));
        EXPECT_EQ(stops.back(), samples);
        std::uint32_t before = 0;
        for (const std::uint32_t stop : stops) {
            EXPECT_GE(stop - before, samples / stops.size());
            EXPECT_LE(stop - before, samples / stops.size() + 1);
            before = stop;
        }
    }
}

// A white ball in white light: every path has radiance 1.
TEST(PixelVarianceTest, NoneInAFurnace) {
    SceneBuilder builder;
    builder.image(6, 5, 60, true).depth(20).environment(1);
    builder.sphere(builder.diffuse(Vec3d(1)), {0, 0, 4}, 3);
    for (const std::uint32_t batches : {30u, 7u}) {
        const WithVariance rendered = render_with_variance(builder.scene, 30, batches);
        EXPECT_EQ(rendered.film.radiance(), std::vector<float>(90, 1.0f));
        EXPECT_EQ(rendered.variance.of_mean(), std::vector<float>(90, 0.0f));
        EXPECT_EQ(rendered.variance.batches(), batches);
    }
}

// The edge of a lamp of radiance 1, 1/2, 1/4: a sample is that or 0, and n samples of mean m have the variance
// m (v - m) n / (n - 1).
TEST(PixelVarianceTest, OfWhatIsThereOrNot) {
    SceneBuilder builder;
    builder.image(8, 8, 90, true);
    builder.quad(builder.emitter({1, 0.5, 0.25}), {10, 10, 4}, 20, 20, {-90, 0, 0});
    builder.scene.camera.look_at = {0.03, 0.02, 1};
    constexpr std::uint32_t samples = 50;
    const WithVariance rendered = render_with_variance(builder.scene, samples, samples);
    const std::vector<float> variance = rendered.variance.of_mean();
    std::uint32_t edges = 0;
    for (std::uint32_t pixel = 0; pixel < 64; ++pixel) {
        const Vec3d mean = rendered.film.pixel(pixel);
        for (std::uint32_t i = 0; i < 3; ++i) {
            const double value = std::array{1.0, 0.5, 0.25}[i];
            const double m = mean[static_cast<int>(i)];
            EXPECT_NEAR(variance[3 * pixel + i], m * (value - m) / (samples - 1), 1e-9) << pixel;
            edges += m > 0 && m < value ? 1 : 0;
        }
    }
    EXPECT_GE(edges, 20u);
}

Scene noisy_room() {
    SceneBuilder builder;
    builder.image(10, 8, 70, true).depth(5);
    builder.room(builder.diffuse({0.7, 0.5, 0.3}), {0, 0, 3}, {2, 2, 3});
    builder.quad(builder.emitter(Vec3d(6)), {0, 1.5, 4}, 1.5, 1.5);
    return builder.scene;
}

// From films of one sample each, by the textbook's two passes.
TEST(PixelVarianceTest, IsThatOfSingleSamples) {
    const Scene scene = noisy_room();
    constexpr std::uint32_t samples = 24;
    std::vector<Film> films;
    RenderRequest request = variance_request(scene, 1, "depth_first");
    request.film_samples = samples;
    for (request.first_sample = 0; request.first_sample < samples; ++request.first_sample) {
        films.push_back(render(scene, request).film);
    }
    const std::vector<float> variance = render_with_variance(scene, samples, samples).variance.of_mean();
    for (std::size_t i = 0; i < variance.size(); ++i) {
        std::vector<double> values;
        for (const Film& film : films) {
            values.push_back(static_cast<double>(film.sums()[i]) / film.scale());
        }
        const double mean = std::accumulate(values.begin(), values.end(), 0.0) / samples;
        double squares = 0;
        for (const double value : values) {
            squares += (value - mean) * (value - mean);
        }
        EXPECT_NEAR(variance[i], squares / (samples - 1) / samples, 1e-6 * squares) << i;
    }
}

// 0 or 1 with equal chances, in batches of 3, 1, 6, 2 and 4 samples: 1/4 / 16 in the mean.
TEST(PixelVarianceTest, IsRightInTheMeanFromUnequalBatches) {
    constexpr std::uint32_t side = 128;
    Film film(side, side, 1, 16);
    PixelVariance variance;
    std::uint64_t state = 1;
    std::uint32_t done = 0;
    for (const std::uint32_t batch : {3u, 1u, 6u, 2u, 4u}) {
        for (std::uint32_t pixel = 0; pixel < side * side; ++pixel) {
            for (std::uint32_t i = 0; i < batch; ++i) {
                state = state * 6364136223846793005ull + 1442695040888963407ull;
                film.view().add(pixel, Vec3<double>(static_cast<double>(state >> 63)));
            }
        }
        done += batch;
        film.set_samples(done);
        variance.add(film);
    }
    const std::vector<float> values = variance.of_mean();
    double mean = 0;
    double squares = 0;
    const auto n = static_cast<double>(side * side);
    for (std::size_t pixel = 0; pixel < side * side; ++pixel) {
        mean += values[3 * pixel] / n;
        squares += values[3 * pixel] * values[3 * pixel] / n;
    }
    const double standard_error = std::sqrt((squares - mean * mean) / n);
    EXPECT_NEAR(mean, 0.25 / 16, 4 * standard_error);
    EXPECT_LT(standard_error, 0.01 * mean);
}

TEST(PixelVarianceTest, LeavesTheFilmsBits) {
    const Scene scene = noisy_room();
    for (const char* const integrator : {"wavefront", "depth_first", "packet"}) {
        const std::string expected = render(scene, variance_request(scene, 23, integrator)).film.hash();
        EXPECT_EQ(render_with_variance(scene, 23, 23, integrator).film.hash(), expected) << integrator;
        EXPECT_EQ(render_with_variance(scene, 23, 4, integrator).film.hash(), expected) << integrator;
    }
}

TEST(PixelVarianceTest, RefusesWhatIsNone) {
    Film film(2, 2, 1, 4);
    film.set_samples(1);
    PixelVariance variance;
    variance.add(film);
    EXPECT_THROW(variance.of_mean(), std::logic_error);
    EXPECT_THROW(variance.add(film), std::logic_error);
}

}  // namespace
}  // namespace pt
