// A small stage whose light is the point of a test, and its image's means by channel: of all pixels and of blocks of
// 16 x 16.
#pragma once

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/render.h"
#include "tests/support/scenes.h"

namespace pt::test {

inline constexpr std::uint32_t side = 32, block = 16;

// The mean of pixels that have as many samples each. How pixels differ is no error of it: only how samples of one do.
class MeanOfPixels {
public:
    void add(const Mean& pixel) {
        pixels_ += 1;
        sum_ += pixel.value();
        squared_errors_ += pixel.standard_error() * pixel.standard_error();
        variances_ += pixel.variance();
    }
    double value() const { return sum_ / pixels_; }
    double standard_error() const { return std::sqrt(squared_errors_) / pixels_; }
    // The variance of a sample about its pixel's mean.
    double variance() const { return variances_ / pixels_; }

private:
    double pixels_ = 0, sum_ = 0, squared_errors_ = 0, variances_ = 0;
};

struct ColourMeanOfPixels {
    MeanOfPixels channel[3];
    void add(const ColourMean& pixel) {
        for (int i = 0; i < 3; ++i) {
            channel[i].add(pixel.channel[i]);
        }
    }
};

// Means of the image, [0], and then of its four blocks. `radiance(pixel, sample)`: the radiance of a path.
template <class Radiance>
std::vector<ColourMeanOfPixels> block_means_of(std::uint32_t samples, const Radiance& radiance) {
    std::vector<ColourMeanOfPixels> means(5);
    for (std::uint32_t pixel = 0; pixel < side * side; ++pixel) {
        ColourMean mean;
        for (std::uint32_t sample = 0; sample < samples; ++sample) {
            mean.add(radiance(pixel, sample));
        }
        const std::uint32_t column = pixel % side / block, row = pixel / side / block;
        means[0].add(mean);
        means[1 + 2 * row + column].add(mean);
    }
    return means;
}

template <class Real>
std::vector<ColourMeanOfPixels> block_means(const Scene& scene, const RenderOptions& options) {
    Stages<Real> stages(scene, options);
    return block_means_of(options.samples,
                          [&](std::uint32_t pixel, std::uint32_t sample) { return stages.radiance(pixel, sample); });
}

// Expects equal mean radiances of two kernels, `off` and `on`, within their standard errors.
inline void expect_equal_means(const std::vector<ColourMeanOfPixels>& off, const std::vector<ColourMeanOfPixels>& on,
                               const std::string& what) {
    for (std::size_t i = 0; i < off.size(); ++i) {
        for (int c = 0; c < 3; ++c) {
            const MeanOfPixels& a = off[i].channel[c];
            const MeanOfPixels& b = on[i].channel[c];
            const double error = std::hypot(a.standard_error(), b.standard_error());
            EXPECT_NEAR(b.value(), a.value(), tolerated_errors * error) << what << " block " << i;
        }
    }
    // 4.5 times this is 7 %: so much of the image is seen for sure, and less is for tests against closed forms, as
    // connection_closed_form_test.cpp.
    const double error = std::hypot(off[0].channel[1].standard_error(), on[0].channel[1].standard_error());
    EXPECT_GT(off[0].channel[1].value(), 0) << what;
    EXPECT_LT(error, 0.015 * off[0].channel[1].value()) << what;
}

// A floor, a wall and a ball, lit by what `add_lights` adds; the ball's material is the point of some scenes.
inline Scene stage(
    const std::function<void(SceneBuilder&)>& add_lights,
    const std::function<std::uint32_t(SceneBuilder&)>& ball = [](auto& b) {
        return b.diffuse({0.75, 0.5, 0.25});
    }) {
    SceneBuilder builder;
    builder.camera({0, 1.5, -4}, {0, 0.8, 0}).image(side, side, 55, true);
    builder.quad(builder.diffuse({0.75, 0.5, 0.25}), {0, 0, 0}, 8, 8);
    builder.quad(builder.diffuse({0.25, 0.5, 0.75}), {0, 2, 2}, 8, 4, {-90, 0, 0});
    builder.sphere(ball(builder), {0, 0.75, 0.25}, 1.5);
    add_lights(builder);
    return builder.scene;
}

inline void lamp(SceneBuilder& builder) { builder.sphere(builder.emitter({4, 5, 6}), {0.5, 3, -1}, 1.2); }

}  // namespace pt::test
