// Case S44: random numbers, their range, and the samplers' results at the ends of the range.
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "harness/stability/case.h"
#include "kernels/light.h"
#include "kernels/materials/mix.h"
#include "kernels/next_event.h"

namespace pt::stability::film_random {
namespace {

// Random numbers at and near the ends of [0, 1]; kernels never draw 1, but a sampler must tolerate it.
template <class Real>
constexpr std::array<Real, 8> ends{Real(0),   Real(0x1p-24),           Real(0.125), Real(0.25),
                                   Real(0.5), Real(1) - Real(0x1p-24), Real(0.75),  Real(1)};

template <class Real>
bool is_finite(const Vec3<Real>& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}
template <class Real>
bool is_unit(const Vec3<Real>& v) {
    return is_finite(v) && std::abs(dot(v, v) - Real(1)) <= 16 * std::numeric_limits<Real>::epsilon();
}

template <class Real>
std::uint64_t map_faults(Real u, Real v) {
    const Vec2<Real> disc = concentric_disc(u, v);
    const Vec3<Real> cosine = cosine_hemisphere(u, v);
    const Real rounding = 4 * std::numeric_limits<Real>::epsilon();
    std::uint64_t faults = 0;
    faults += disc.x * disc.x + disc.y * disc.y <= Real(1) + rounding ? 0 : 1;
    faults += is_unit(cosine) && cosine.z >= Real(0) ? 0 : 1;
    faults += is_unit(uniform_sphere(u, v)) ? 0 : 1;
    for (const Real g : {Real(-0.9999), Real(-0.5), Real(0), Real(0x1p-20), Real(0.5), Real(0.9999)}) {
        const Real c = henyey_greenstein_cosine(g, u);
        faults += c >= Real(-1) && c <= Real(1) ? 0 : 1;
    }
    // A number of positive_unit_interval is never 0, so its logarithm is finite.
    faults += u == Real(0) || (std::isfinite(logarithm(u)) && logarithm(u) <= Real(0)) ? 0 : 1;
    return faults;
}

template <class Body, class Real>
std::uint64_t light_faults(const Body& body, Real u, Real v, Real w) {
    std::uint64_t faults = 0;
    const LightSample<Real> point = sample_point(body, u, v, w);
    faults += is_finite(point.position) && is_unit(point.normal) && point.inverse_density > Real(0) &&
                      std::isfinite(point.inverse_density)
                  ? 0
                  : 1;
    // Points from which the light is sampled: far away, near by, and inside.
    for (const Vec3<Real>& observer : {Vec3<Real>(0, -1000, 0), Vec3<Real>(0.25, Real(-1.0009765625), 0.125),
                                       Vec3<Real>(3, 2, 1), Vec3<Real>(0.125, 0, 0.25)}) {
        const DirectionSample<Real> direction = sample_direction(body, observer, u, v, w);
        faults += direction.inverse_pdf >= Real(0) && std::isfinite(direction.inverse_pdf) &&
                          (direction.inverse_pdf == Real(0) || is_unit(direction.direction))
                      ? 0
                      : 1;
    }
    return faults;
}

template <class Real>
std::uint64_t sampler_faults() {
    const Sphere<Real> sphere{{0, 0, 0}, Real(1), Real(1)};
    const Ellipsoid<Real> ellipsoid{
        {0, 0, 0}, {{2, 0, 0}, {0, 1, 0}, {0, 0, Real(0.5)}}, {{Real(0.5), 0, 0}, {0, 1, 0}, {0, 0, 2}}};
    const AxisBox<Real> axis_box{{-1, -1, -1}, {1, 1, 1}};
    const OrientedBox<Real> oriented_box{
        {0, 0, 0}, {{Real(0.6), Real(0.8), 0}, {Real(-0.8), Real(0.6), 0}, {0, 0, 1}}, {1, Real(0.5), 2}};
    const Quad<Real> quad{{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {0, 0, 1}, Real(1), Real(2)};
    std::uint64_t faults = 0;
    for (const Real u : ends<Real>) {
        for (const Real v : ends<Real>) {
            faults += map_faults(u, v);
            for (const Real w : ends<Real>) {
                faults += light_faults(sphere, u, v, w) + light_faults(ellipsoid, u, v, w) +
                          light_faults(axis_box, u, v, w) + light_faults(oriented_box, u, v, w) +
                          light_faults(quad, u, v, w);
            }
        }
    }
    return faults;
}

// Choosing a light by the high word of the product with the number of lights must never give an index out of range.
std::uint64_t index_faults() {
    std::uint64_t faults = 0;
    for (const std::uint32_t lights : {1u, 2u, 3u, 7u, 1000003u, 0x7ffffffu}) {
        for (const std::uint32_t word : {0u, 0x7fffffffu, 0xffffff00u, 0xffffffffu}) {
            faults += ((static_cast<std::uint64_t>(word) * lights) >> 32) < lights ? 0 : 1;
        }
    }
    return faults;
}

Measurement fault_count(const std::string& quantity, std::uint64_t count) {
    return {.quantity = quantity,
            .measured = static_cast<double>(count),
            .exact = 0,
            .tolerance = {0, 0, "numerics.md S44d: finite, and in range"}};
}

template <class Real>
std::vector<Measurement> ends_of_range() {
    const double step = sizeof(Real) == 4 ? 0x1p-24 : 0x1p-32;
    const Tolerance none{0, 0, "numerics.md S44d: never 1, and never the logarithm of 0"};
    return {{.quantity = "largest random number",
             .measured = static_cast<double>(unit_interval<Real>(0xffffffffu)),
             .exact = 1 - step,
             .relation = Relation::at_most,
             .tolerance = none},
            {.quantity = "smallest argument of a logarithm",
             .measured = static_cast<double>(positive_unit_interval<Real>(0)),
             .exact = 0x1p-33,
             .relation = Relation::at_least,
             .tolerance = none},
            fault_count("directions, points and cosines that are none", sampler_faults<Real>()),
            fault_count("lights out of range", index_faults()),
            fault_count("lobes chosen that have no probability, or not chosen that have all",
                        (chooses_mirror(Real(0), Real(0)) ? 1u : 0u) +
                            (chooses_mirror(unit_interval<Real>(0xffffffffu), Real(1)) ? 0u : 1u))};
}

std::vector<Measurement> random_range(const Values&, const DirectSetting& setting) {
    return setting.precision.is_double() ? ends_of_range<double>() : ends_of_range<float>();
}

enum class Source { pcg4d, philox, minstd };

RandomWords words_of(Source source, const RandomSeed& seed, const RandomKey& key) {
    switch (source) {
        case Source::philox:
            return random_words<Config<double, no_features | Feature::philox>>(seed, key);
        case Source::minstd:
            return random_words<Config<double, no_features | Feature::minstd>>(seed, key);
        default:
            return random_words<Config<double, no_features>>(seed, key);
    }
}

// Variance over pixels of the scaled mean (mean - 1/2) sqrt(12 N) of N random numbers; 1 if these are independent.
double dispersion(Source source, const RandomSeed& seed, std::uint32_t bounce, std::uint32_t pixels,
                  std::uint32_t samples) {
    double squares = 0;
    for (std::uint32_t pixel = 0; pixel < pixels; ++pixel) {
        double sum = 0;
        for (std::uint32_t sample = 0; sample < samples; ++sample) {
            sum += unit_interval<double>(words_of(source, seed, {pixel, sample, bounce, 0}).y) - 0.5;
        }
        squares += sum * sum * 12 / samples;
    }
    return squares / pixels;
}

// Counts keys (pixel, sample, bounce, block) whose four random words equal those of another key of the grid tested.
std::uint64_t repeated_words(Source source, const RandomSeed& seed, std::uint32_t samples) {
    std::vector<std::array<std::uint32_t, 4>> all;
    for (std::uint32_t pixel = 0; pixel < 64; ++pixel) {
        for (std::uint32_t sample = 0; sample < samples; ++sample) {
            for (const std::uint32_t bounce : {0u, 1u, 2u, 65535u, 65536u, 999999u}) {
                for (const std::uint32_t block : {0u, 1u, 2u, 65536u}) {
                    const RandomWords words = words_of(source, seed, {pixel, sample, bounce, block});
                    all.push_back({words.x, words.y, words.z, words.w});
                }
            }
        }
    }
    std::sort(all.begin(), all.end());
    const auto distinct = static_cast<std::size_t>(std::unique(all.begin(), all.end()) - all.begin());
    return all.size() - distinct;
}

double lag_correlation(Source source, const RandomSeed& seed, const RandomKey& lag, std::uint32_t count) {
    double sum = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
        const RandomKey key{i, 3, 1, 0};
        const RandomWords here = words_of(source, seed, key);
        const RandomWords there = words_of(
            source, seed, {key.pixel + lag.pixel, key.sample + lag.sample, key.bounce + lag.bounce, key.block});
        sum += 12 * (unit_interval<double>(here.y) - 0.5) * (unit_interval<double>(there.y) - 0.5);
    }
    return sum / count;
}

std::vector<Measurement> random_keys(const Values& v, const DirectSetting& setting) {
    const Source source = setting.is_naive ? Source::minstd : v.is_set("philox") ? Source::philox : Source::pcg4d;
    const RandomSeed seed = RandomSeed::from(static_cast<std::uint64_t>(v["seed"]));
    const std::uint32_t pixels = setting.is_quick ? 1u << 12 : 1u << 16;
    const double five_errors = 5 * std::sqrt(2.0 / pixels);
    std::vector<Measurement> measurements;
    for (const std::uint32_t bounce : {1u, 2u, 7u}) {
        measurements.push_back({.quantity = "dispersion of a pixel's mean at bounce " + std::to_string(bounce),
                                .measured = dispersion(source, seed, bounce, pixels, 64),
                                .exact = 1,
                                .tolerance = {five_errors, five_errors, "numerics.md S44b: five standard errors"}});
    }
    measurements.push_back(fault_count("keys with the words of another", repeated_words(source, seed, 64)));
    const double five_lags = 5 / std::sqrt(static_cast<double>(pixels));
    for (const auto& [name, lag] : {std::pair{"pixels", RandomKey{1, 0, 0, 0}},
                                    {"samples", RandomKey{0, 1, 0, 0}},
                                    {"bounces", RandomKey{0, 0, 1, 0}}}) {
        measurements.push_back({.quantity = std::string("correlation of neighbouring ") + name,
                                .measured = lag_correlation(source, seed, lag, pixels),
                                .exact = 0,
                                .tolerance = {five_lags, five_lags, "numerics.md S44e: five standard errors"}});
    }
    return measurements;
}

const CasesOf<Family::film> cases({
    {.name = "random_range",
     .catalogue = "S44",
     .title = "every sampler at the ends of the unit interval",
     .stiff = "a random number of exactly 1 picks a light that is not there, one of 0 has no logarithm",
     .formula = "u in [0, 1 - 2^-24], in double [0, 1 - 2^-32]; -log u of u >= 2^-33; directions of length 1",
     .direct = random_range},
    {.name = "random_keys",
     .catalogue = "S44",
     .title = "random numbers of neighbouring keys are independent",
     .stiff = "streams that overlap or are seeded alike: the noise of an image is more than its samples say",
     .formula = "variance over pixels of (mean - 1/2) sqrt(12 N): 1; correlations: 0; no two keys of the same words",
     .parameters = {{"seed", 6, 0, 1e15, "of the numbers", true},
                    {"philox", 0, 0, 1, "0: pcg4d, 1: philox; minstd, seeded by position, is the naive twin", true}},
     .points = along("philox", {0, 1}),
     .quick_points = {{{"philox", 0}}},
     .direct = random_keys,
     .direct_has_naive = true},
});

}  // namespace
}  // namespace pt::stability::film_random
