// Vectors for tests, from a seeded number source.
#pragma once

#include "kernels/math.h"
#include "tests/support/statistics.h"

namespace pt::test {

// Evenly spread over [-half, half)^3.
template <class Real>
Vec3<Real> random_in_cube(Random& random, double half) {
    return {static_cast<Real>(random.uniform(-half, half)), static_cast<Real>(random.uniform(-half, half)),
            static_cast<Real>(random.uniform(-half, half))};
}

}  // namespace pt::test
