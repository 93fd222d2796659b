// Sine, cosine and random numbers that have the same bits on every machine: double precision, with sums and products in
// the order written. The C library is not used, since the last bit of its sine differs between versions and processors.
// (The build's -ffp-contract=off keeps compilers from fusing operations.)
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace pt {

inline constexpr double exact_pi = 3.14159265358979323846;

struct SineCosine {
    double sine, cosine;
};

// Sine and cosine within 2 units in the last place of 1, for |x| up to 10^5: x is reduced by a multiple of pi/2 in two
// parts (Cody and Waite 1980), the first of which has 33 bits, then Taylor's series up to the 18th power.
inline SineCosine exact_sine_cosine(double x) {
    constexpr double half_pi_high = 0x1.921fb544p+0, half_pi_low = 0x1.0b4611a626331p-34;
    const double turns = std::floor(x * (2.0 / exact_pi) + 0.5);
    const double r = (x - turns * half_pi_high) - turns * half_pi_low, r2 = r * r;
    double sine = 0.0, cosine = 0.0;
    for (int power = 18; power >= 2; power -= 2) {
        sine = (1.0 - sine) * r2 / (power * (power + 1));
        cosine = (1.0 - cosine) * r2 / (power * (power - 1));
    }
    sine = r * (1.0 - sine);
    cosine = 1.0 - cosine;
    switch (static_cast<std::int64_t>(turns) & 3) {
        case 0:
            return {sine, cosine};
        case 1:
            return {cosine, -sine};
        case 2:
            return {-sine, -cosine};
        default:
            return {-cosine, sine};
    }
}

inline std::array<float, 3> in_single(const glm::dvec3& point) {
    return {static_cast<float>(point.x), static_cast<float>(point.y), static_cast<float>(point.z)};
}

// SplitMix64 (Steele, Lea, Flood 2014): the n-th number depends on the seed and n alone.
class MeshRandom {
public:
    explicit MeshRandom(std::uint64_t seed) : state_(seed) {}

    std::uint64_t bits() {
        state_ += 0x9e3779b97f4a7c15ull;
        std::uint64_t z = state_;
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
        return z ^ (z >> 31);
    }
    // A random number in [0, 1), in steps of 2^-53.
    double uniform() { return static_cast<double>(bits() >> 11) * 0x1p-53; }
    double uniform(double low, double high) { return low + (high - low) * uniform(); }
    // A random point in the cube [low, high)^3.
    glm::dvec3 point(double low, double high) {
        const double x = uniform(low, high), y = uniform(low, high), z = uniform(low, high);
        return {x, y, z};
    }
    // A random direction, evenly on the unit sphere (Archimedes).
    glm::dvec3 direction() {
        const double z = uniform(-1.0, 1.0), r = std::sqrt(1.0 - z * z);
        const SineCosine angle = exact_sine_cosine(uniform(0.0, 2.0 * exact_pi));
        return {r * angle.cosine, r * angle.sine, z};
    }

private:
    std::uint64_t state_;
};

}  // namespace pt
