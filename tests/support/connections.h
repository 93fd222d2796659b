// What next-event estimation brings at rough surfaces, held to what lobes meet by themselves.
#pragma once

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/render.h"

namespace pt::test {

// The green mean of a scene of one pixel, to a twentieth on both sides, for every exponent of the weights.
template <class Real>
void expect_connections_bring_what_lobes_meet(const Scene& scene, double roughness) {
    const auto mean = [&](const RenderOptions& options) { return mean_radiance<Real>(scene, options).channel[1]; };
    const Mean met = mean({.samples = 1 << 18, .seed = 11});
    EXPECT_LT(met.standard_error(), 0.05 / tolerated_errors * met.value()) << roughness;
    for (const std::uint32_t exponent : {0u, 1u, 2u}) {
        const Mean connected =
            mean({.samples = 1 << 18, .seed = 12 + exponent, .next_event = true, .mis_exponent = exponent});
        EXPECT_LT(connected.standard_error(), 0.05 / tolerated_errors * met.value()) << roughness << " " << exponent;
        EXPECT_NEAR(connected.value(), met.value(),
                    tolerated_errors * std::hypot(connected.standard_error(), met.standard_error()))
            << roughness << " " << exponent;
    }
}

}  // namespace pt::test
