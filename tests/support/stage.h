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

// [0]: the image; then its four blocks.
template <class Real>
std::vector<ColourMean> block_means(const Scene& scene, const RenderOptions& options) {
    Stages<Real> stages(scene, options);
    std::vector<ColourMean> means(5);
    for (std::uint32_t pixel = 0; pixel < side * side; ++pixel) {
        const std::uint32_t column = pixel % side / block, row = pixel / side / block;
        for (std::uint32_t sample = 0; sample < options.samples; ++sample) {
            const Vec3d radiance = stages.radiance(pixel, sample);
            means[0].add(radiance);
            means[1 + 2 * row + column].add(radiance);
        }
    }
    return means;
}

// Both are means of the same, however many samples each is of.
inline void expect_equal_means(const std::vector<ColourMean>& off, const std::vector<ColourMean>& on,
                               const std::string& what) {
    for (std::size_t i = 0; i < off.size(); ++i) {
        for (int c = 0; c < 3; ++c) {
            const Mean& a = off[i].channel[c];
            const Mean& b = on[i].channel[c];
            const double error = std::hypot(a.standard_error(), b.standard_error());
            EXPECT_NEAR(b.value(), a.value(), tolerated_errors * error) << what << " block " << i;
        }
    }
    // A test that cannot see 3 % of the image is none.
    const double error = std::hypot(off[0].channel[1].standard_error(), on[0].channel[1].standard_error());
    EXPECT_GT(off[0].channel[1].value(), 0) << what;
    EXPECT_LT(error, 0.03 * off[0].channel[1].value()) << what;
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
