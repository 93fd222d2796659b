// Every sampling routine against its density, by chi-square, and at the corners of the unit square.
#include "kernels/sampling.h"

#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "kernels/light.h"
#include "tests/support/render.h"
#include "tests/support/scenes.h"

namespace pt {
namespace {

using test::chi_square_alpha;
using test::chi_square_test;

constexpr double two_pi = 2 * pi<double>;

template <class Real>
class SamplingTest : public testing::Test {};
using Reals = testing::Types<float, double>;
TYPED_TEST_SUITE(SamplingTest, Reals);

// Counts in a grid of cells over the unit square.
class Grid {
public:
    Grid(std::size_t columns, std::size_t rows) : columns_(columns), rows_(rows), counts_(columns * rows) {}

    void add(double a, double b) { counts_[cell(a, columns_) * rows_ + cell(b, rows_)] += 1; }
    double p_value() const { return chi_square_test(counts_); }
    double p_value(const std::vector<double>& probabilities) const { return chi_square_test(counts_, probabilities); }

private:
    // Rounding may carry a coordinate out by an ulp; more than that is a fault that must show.
    static std::size_t cell(double value, std::size_t cells) {
        EXPECT_GE(value, -1e-6);
        EXPECT_LE(value, 1 + 1e-6);
        return static_cast<std::size_t>(
            std::min(std::max(value, 0.0) * static_cast<double>(cells), static_cast<double>(cells) - 0.5));
    }
    std::size_t columns_, rows_;
    std::vector<std::uint64_t> counts_;
};

double turn_of(double x, double y) {
    const double angle = std::atan2(y, x) / two_pi;
    return angle < 0 ? angle + 1 : angle;
}

template <class Real, class Body>
void for_random_squares(std::uint64_t seed, int count, Body&& body) {
    test::Random random(seed);
    for (int i = 0; i < count; ++i) {
        const Real u = unit_interval<Real>(random.word());
        const Real v = unit_interval<Real>(random.word());
        body(u, v);
    }
}

constexpr int draws = 200000;

TYPED_TEST(SamplingTest, ConcentricDiscIsUniform) {
    using Real = TypeParam;
    Grid grid(16, 32);
    for_random_squares<Real>(1, draws, [&](Real u, Real v) {
        const Vec2<Real> p = concentric_disc(u, v);
        grid.add(double(p.x) * p.x + double(p.y) * p.y, turn_of(p.x, p.y));
    });
    EXPECT_GT(grid.p_value(), chi_square_alpha);
}

TYPED_TEST(SamplingTest, ConcentricDiscKeepsNeighboursTogether) {
    using Real = TypeParam;
    // What sets the map apart from polar coordinates (where it is 2 pi / n): a step of 1/n in both numbers moves the
    // point by at most sqrt(2^2 + pi^2) / n, reached at the corners: 2/n along the radius and pi/n across.
    constexpr int n = 64;
    for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) {
            const auto a = concentric_disc(Real(i) / n, Real(j) / n);
            const auto b = concentric_disc(Real(i + 1) / n, Real(j + 1) / n);
            ASSERT_LT(std::hypot(a.x - b.x, a.y - b.y), std::sqrt(4 + pi<Real> * pi<Real>) / n);
        }
    }
}

TYPED_TEST(SamplingTest, CosineHemisphereHasDensityCosine) {
    using Real = TypeParam;
    Grid grid(16, 32);
    for_random_squares<Real>(2, draws, [&](Real u, Real v) {
        const Vec3<Real> p = cosine_hemisphere(u, v);
        ASSERT_NEAR(dot(p, p), Real(1), 4 * std::numeric_limits<Real>::epsilon());
        ASSERT_GE(p.z, Real(0));
        grid.add(double(p.z) * p.z, turn_of(p.x, p.y));  // density z / pi: z^2 is uniform
    });
    EXPECT_GT(grid.p_value(), chi_square_alpha);
}

TYPED_TEST(SamplingTest, UniformSphereIsUniform) {
    using Real = TypeParam;
    Grid grid(16, 32);
    for_random_squares<Real>(3, draws, [&](Real u, Real v) {
        const Vec3<Real> p = uniform_sphere(u, v);
        ASSERT_NEAR(dot(p, p), Real(1), 6 * std::numeric_limits<Real>::epsilon());
        grid.add(0.5 * (1 + double(p.z)), turn_of(p.x, p.y));
    });
    EXPECT_GT(grid.p_value(), chi_square_alpha);
}

// Probability that the cosine is below mu.
double henyey_greenstein_cdf(double g, double mu) {
    if (std::abs(g) < 1e-9) {
        return 0.5 * (1 + mu);
    }
    const long double lg = g;
    const long double root = sqrtl(1 + lg * lg - 2 * lg * mu);
    return static_cast<double>((1 - lg * lg) / (2 * lg) * (1 / root - 1 / (1 + lg)));
}

TYPED_TEST(SamplingTest, HenyeyGreensteinHasItsDensityAndItsMean) {
    using Real = TypeParam;
    for (const double g : {0.0, 0.0005, -0.0005, 0.000999, 0.001001, 0.1, -0.3, 0.9, -0.9, 0.99}) {
        Grid grid(64, 1);
        test::Mean mean;
        for_random_squares<Real>(4, draws, [&](Real u, Real) {
            const double mu = henyey_greenstein_cosine(static_cast<Real>(g), u);
            grid.add(henyey_greenstein_cdf(g, mu), 0.5);
            mean.add(mu);
        });
        EXPECT_GT(grid.p_value(), chi_square_alpha) << g;
        EXPECT_NEAR(mean.value(), g, test::tolerated_errors * mean.standard_error()) << g;
    }
}

TYPED_TEST(SamplingTest, HenyeyGreensteinInvertsItsDistribution) {
    using Real = TypeParam;
    // Midpoints over u: no noise, so that the mean cosine is seen to 1e-7.
    constexpr int steps = 1 << 16;
    for (const double g : {0.0, 0.0005, -0.0005, 0.001, -0.001, 0.0011, 0.05, 0.5, -0.9}) {
        double sum = 0;
        for (int i = 0; i < steps; ++i) {
            sum += henyey_greenstein_cosine(static_cast<Real>(g), static_cast<Real>((i + 0.5) / steps));
        }
        // Rounding is 6e-8 a draw; the midpoint rule's own error at |g| = 0.9 is below 1e-8.
        EXPECT_NEAR(sum / steps, g, sizeof(Real) == 4 ? 1e-7 : 1e-8) << g;
    }
}

constexpr double corners[] = {0.0, 0x1p-24, 0.5, 1.0 - 0x1p-24, 0.99999999999};

template <class Real>
bool finite(const Vec3<Real>& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

TYPED_TEST(SamplingTest, EveryMapIsFiniteAndInRangeAtTheCorners) {
    using Real = TypeParam;
    const Real slack = 8 * std::numeric_limits<Real>::epsilon();
    for (const double a : corners) {
        for (const double b : corners) {
            // "Almost 1" is 1 in float: a caller must never pass it, yet nothing may break.
            const Real u = static_cast<Real>(a), v = static_cast<Real>(b);
            const Vec2<Real> disc = concentric_disc(u, v);
            EXPECT_LE(disc.x * disc.x + disc.y * disc.y, 1 + slack) << a << " " << b;
            const Vec3<Real> hemisphere = cosine_hemisphere(u, v);
            EXPECT_TRUE(finite(hemisphere));
            EXPECT_GE(hemisphere.z, Real(0));
            EXPECT_NEAR(dot(hemisphere, hemisphere), Real(1), slack);
            const Vec3<Real> sphere = uniform_sphere(u, v);
            EXPECT_NEAR(dot(sphere, sphere), Real(1), slack);
            for (const double g : {0.0, 0.0005, -0.0005, 0.9, -0.9, 0.9999, -0.9999}) {
                const Real cosine = henyey_greenstein_cosine(static_cast<Real>(g), u);
                EXPECT_GE(cosine, Real(-1));
                EXPECT_LE(cosine, Real(1));
            }
            for (const double c : corners) {
                const Real w = static_cast<Real>(c);
                const Vec3<Real> half{1, 2, 3};
                const LightSample<Real> box = sample_box(half, u, v, w);
                for (int axis = 0; axis < 3; ++axis) {
                    EXPECT_LE(std::abs(box.position[axis]), half[axis]);
                }
                EXPECT_EQ(dot(box.normal, box.normal), Real(1));
                EXPECT_GT(dot(box.position, box.normal), Real(0));
            }
        }
    }
}

TYPED_TEST(SamplingTest, HenyeyGreensteinReachesBothEnds) {
    using Real = TypeParam;
    for (const double g : {0.0, 0.0005, 0.3, -0.3, 0.9, -0.9}) {
        // u = 0 is straight on, u = 1 straight back.
        const Real tolerance = 4 * std::numeric_limits<Real>::epsilon();
        EXPECT_NEAR(henyey_greenstein_cosine(static_cast<Real>(g), Real(0)), Real(1), tolerance);
        EXPECT_NEAR(henyey_greenstein_cosine(static_cast<Real>(g), Real(1)), Real(-1), tolerance);
    }
}

// --- Points on lights
// -------------------------------------------------------------------------------------------------

// The light of a scene with one object, as the kernels see it.
template <class Real>
class OneLight {
public:
    explicit OneLight(const std::function<void(test::SceneBuilder&, std::uint32_t)>& add)
        : scene_(make(add)), stages_(scene_) {}

    LightSample<Real> sample(Real u, Real v, Real w) const {
        return sample_light<Config<Real, all_features>>(stages_.view(), stages_.view().lights[0].object, Real(0), u, v,
                                                        w);
    }

private:
    static Scene make(const std::function<void(test::SceneBuilder&, std::uint32_t)>& add) {
        test::SceneBuilder builder;
        add(builder, builder.emitter(Vec3d(1.0)));
        return builder.scene;
    }
    Scene scene_;
    test::Stages<Real> stages_;
};

// The object's own frame: x = R S local + centre.
Vec3d to_local(const Vec3d& p, const Vec3d& centre, const Vec3d& scale, const Vec3d& degrees) {
    const Rotation rotation = rotation_of(degrees);
    const Vec3d q = p - centre;
    return Vec3d{dot(rotation.column[0], q), dot(rotation.column[1], q), dot(rotation.column[2], q)} / scale;
}

const Vec3d light_centre{1, 2, -3};
const Vec3d light_turn{30, -50, 110};

TYPED_TEST(SamplingTest, LightPointsOnASphereAreUniform) {
    using Real = TypeParam;
    const OneLight<Real> light([](auto& b, auto m) { b.sphere(m, light_centre, 3); });
    Grid grid(16, 32);
    for_random_squares<Real>(11, draws, [&](Real u, Real v) {
        const LightSample<Real> sample = light.sample(u, v, 0);
        const Vec3d p = (Vec3d(sample.position) - light_centre) / 1.5;
        ASSERT_NEAR(dot(p, p), 1, 1e-5);
        ASSERT_NEAR(dot(p, Vec3d(sample.normal)), 1, 1e-5);
        grid.add(0.5 * (1 + p.z), turn_of(p.x, p.y));
        ASSERT_NEAR(sample.inverse_density / (4 * pi<Real> * Real(2.25)), Real(1), Real(1e-6));
    });
    EXPECT_GT(grid.p_value(), chi_square_alpha);
}

TYPED_TEST(SamplingTest, LightPointsOnAQuadAreUniform) {
    using Real = TypeParam;
    const OneLight<Real> light([](auto& b, auto m) { b.quad(m, light_centre, 3, 0.5, light_turn); });
    Grid grid(20, 20);
    for_random_squares<Real>(12, draws, [&](Real u, Real v) {
        const LightSample<Real> sample = light.sample(u, v, 0);
        const Vec3d p = to_local(Vec3d(sample.position), light_centre, {3, 1, 0.5}, light_turn);
        ASSERT_NEAR(p.y, 0, 2e-6);
        ASSERT_NEAR(dot(Vec3d(sample.normal), rotation_of(light_turn).column[1]), 1, 1e-6);
        grid.add(p.x + 0.5, p.z + 0.5);
        ASSERT_NEAR(sample.inverse_density, Real(1.5), Real(1e-6));
    });
    EXPECT_GT(grid.p_value(), chi_square_alpha);
}

template <class Real>
void check_box_light(const Vec3d& degrees) {
    const Vec3d size{1, 2, 4};
    const OneLight<Real> light([&](auto& b, auto m) { b.box(m, light_centre, size, degrees); });
    constexpr std::size_t side = 8;
    std::vector<std::uint64_t> counts(6 * side * side);
    std::vector<double> probabilities;
    const double area[3] = {size.y * size.z, size.z * size.x, size.x * size.y};
    const double total = 2 * (area[0] + area[1] + area[2]);
    for (int face = 0; face < 6; ++face) {
        probabilities.insert(probabilities.end(), side * side, area[face / 2] / total / (side * side));
    }
    test::Random random(13);
    for (int i = 0; i < draws; ++i) {
        const Real u = unit_interval<Real>(random.word()), v = unit_interval<Real>(random.word());
        const LightSample<Real> sample = light.sample(u, v, unit_interval<Real>(random.word()));
        const Vec3d p = to_local(Vec3d(sample.position), light_centre, size, degrees);
        const Vec3d n = to_local(Vec3d(sample.normal), Vec3d(0.0), Vec3d(1.0), degrees);
        int axis = 0;
        for (int k = 1; k < 3; ++k) {
            axis = std::abs(n[k]) > std::abs(n[axis]) ? k : axis;
        }
        ASSERT_NEAR(std::abs(n[axis]), 1, 1e-6);
        ASSERT_NEAR(p[axis], n[axis] > 0 ? 0.5 : -0.5, 4e-6);
        const auto cell = [](double x) {
            return std::min(side - 1, static_cast<std::size_t>(std::max(0.0, (x + 0.5) * side)));
        };
        const std::size_t face = static_cast<std::size_t>(2 * axis + (n[axis] > 0 ? 1 : 0));
        counts[(face * side + cell(p[(axis + 1) % 3])) * side + cell(p[(axis + 2) % 3])] += 1;
        ASSERT_NEAR(sample.inverse_density / total, 1, 1e-6);
    }
    EXPECT_GT(chi_square_test(counts, probabilities), chi_square_alpha);
}

TYPED_TEST(SamplingTest, LightPointsOnAnAxisBoxAreUniform) { check_box_light<TypeParam>(Vec3d(0.0)); }
TYPED_TEST(SamplingTest, LightPointsOnAnOrientedBoxAreUniform) { check_box_light<TypeParam>(light_turn); }

// The points of an ellipsoid are not uniform by area, so each carries its own density. Count in cells of latitude and
// longitude against the integral of that density over each cell's area, the area element taken from the
// parametrisation.
TYPED_TEST(SamplingTest, LightPointsOnAnEllipsoidFollowTheirDensity) {
    using Real = TypeParam;
    const Vec3d size{1, 3, 0.4};
    const OneLight<Real> light([&](auto& b, auto m) { b.ellipsoid(m, light_centre, size, light_turn); });
    constexpr std::size_t columns = 16, rows = 24;
    constexpr int fine = 6;  // quadrature points a side of a cell
    std::vector<double> probabilities;
    double total = 0, area = 0;
    for (std::size_t i = 0; i < columns; ++i) {
        for (std::size_t j = 0; j < rows; ++j) {
            double cell = 0;
            for (int a = 0; a < fine; ++a) {
                for (int b = 0; b < fine; ++b) {
                    const double s = (static_cast<double>(i) + (a + 0.5) / fine) / columns;
                    const double t = (static_cast<double>(j) + (b + 0.5) / fine) / rows;
                    const double z = 2 * s - 1, r = std::sqrt(1 - z * z), phi = two_pi * t;
                    // Partial derivatives of S f / 2 over z and phi, in the object's frame.
                    const Vec3d half = size * 0.5;
                    const Vec3d by_z{half.x * -z / r * std::cos(phi), half.y * -z / r * std::sin(phi), half.z};
                    const Vec3d by_phi{half.x * -r * std::sin(phi), half.y * r * std::cos(phi), 0};
                    const Vec3d normal = cross(by_z, by_phi);
                    const double element = std::sqrt(dot(normal, normal)) * 2 * two_pi / (columns * rows * fine * fine);
                    const LightSample<Real> sample = light.sample(static_cast<Real>(1 - s), static_cast<Real>(t), 0);
                    cell += element / sample.inverse_density;
                    area += element;
                }
            }
            probabilities.push_back(cell);
            total += cell;
        }
    }
    EXPECT_NEAR(total, 1, 1e-5);  // the density integrates to 1
    Grid grid(columns, rows);
    test::Mean inverse_density;
    for_random_squares<Real>(14, draws, [&](Real u, Real v) {
        const LightSample<Real> sample = light.sample(u, v, 0);
        const Vec3d f = to_local(Vec3d(sample.position), light_centre, size * 0.5, light_turn);
        ASSERT_NEAR(dot(f, f), 1, 2e-5);
        // The normal of x^T S^-2 x: parallel to S^-1 f.
        const Vec3d n = normalize(f / size);
        ASSERT_NEAR(dot(n, to_local(Vec3d(sample.normal), Vec3d(0.0), Vec3d(1.0), light_turn)), 1, 1e-5);
        grid.add(0.5 * (1 + f.z), turn_of(f.x, f.y));
        inverse_density.add(sample.inverse_density);
    });
    EXPECT_GT(grid.p_value(probabilities), chi_square_alpha);
    EXPECT_NEAR(inverse_density.value(), area, test::tolerated_errors * inverse_density.standard_error() + 1e-3 * area);
}

TYPED_TEST(SamplingTest, MovingLightIsSampledWhereItIs) {
    using Real = TypeParam;
    test::SceneBuilder builder;
    builder.sphere(builder.emitter(Vec3d(1.0)), {0, 0, 4}, 2).velocity = {8, 0, -2};
    const test::Stages<Real> stages(builder.scene);
    const auto still =
        sample_light<Config<Real, all_features>>(stages.view(), 0, Real(0), Real(0.3), Real(0.6), Real(0));
    const auto moved =
        sample_light<Config<Real, all_features>>(stages.view(), 0, Real(0.5), Real(0.3), Real(0.6), Real(0));
    EXPECT_NEAR(moved.position.x - still.position.x, Real(4), Real(1e-5));
    EXPECT_NEAR(moved.position.z - still.position.z, Real(-1), Real(1e-5));
    EXPECT_EQ(moved.normal, still.normal);
}

// --- The camera
// ---------------------------------------------------------------------------------------------------------

TYPED_TEST(SamplingTest, PixelJitterFillsThePixelEvenly) {
    using Real = TypeParam;
    test::SceneBuilder builder;
    builder.image(8, 4, 90, true);
    const test::Stages<Real> stages(builder.scene);
    const std::uint32_t column = 6, row = 1;
    Grid grid(20, 20);
    for (std::uint32_t sample = 0; sample < draws; ++sample) {
        const Path<Real> path = stages.generate(row * 8 + column, sample);
        // Back to pixels: at distance 1 the image spans [-1, 1] vertically in 4 rows, and x grows to the camera's
        // right.
        const auto& camera = stages.view().camera;
        const double x = dot(path.direction, camera.right) / dot(path.direction, camera.forward) * 2 + 4;
        const double y = -dot(path.direction, camera.up) / dot(path.direction, camera.forward) * 2 + 2;
        grid.add(x - column, y - row);
    }
    EXPECT_GT(grid.p_value(), chi_square_alpha);
}

TYPED_TEST(SamplingTest, LensIsFilledEvenly) {
    using Real = TypeParam;
    test::SceneBuilder builder;
    builder.scene.camera.aperture_radius = 0.25;
    builder.scene.camera.focus_distance = 3;
    const test::Stages<Real> stages(builder.scene);
    Grid grid(16, 32);
    for (std::uint32_t sample = 0; sample < draws; ++sample) {
        const Path<Real> path = stages.generate(0, sample);
        const Vec3d p = Vec3d(path.origin) / 0.25;
        ASSERT_EQ(p.z, 0);
        grid.add(p.x * p.x + p.y * p.y, turn_of(p.x, p.y));
        // Every ray of the pixel's centre meets the point in focus.
        const Vec3d focus = Vec3d(path.origin) + Vec3d(path.direction) * (3.0 / static_cast<double>(path.direction.z));
        ASSERT_NEAR(focus.x, 0, 1e-6);
        ASSERT_NEAR(focus.y, 0, 1e-6);
    }
    EXPECT_GT(grid.p_value(), chi_square_alpha);
}

TYPED_TEST(SamplingTest, ShutterTimesFollowTheirDensity) {
    using Real = TypeParam;
    for (const bool late : {false, true}) {
        test::SceneBuilder builder;
        builder.scene.camera.shutter_open = 2;
        builder.scene.camera.shutter_close = 6;
        builder.scene.camera.shutter_late = late;
        const test::Stages<Real> stages(builder.scene);
        Grid grid(64, 1);
        for (std::uint32_t sample = 0; sample < draws; ++sample) {
            const double s = (static_cast<double>(stages.generate(0, sample).time) - 2) / 4;
            grid.add(late ? s * s : s, 0.5);  // the distribution function is uniform
        }
        EXPECT_GT(grid.p_value(), chi_square_alpha) << late;
    }
}

TYPED_TEST(SamplingTest, ClosedShutterShowsItsInstant) {
    using Real = TypeParam;
    test::SceneBuilder builder;
    builder.scene.camera.shutter_open = builder.scene.camera.shutter_close = 0.75;
    const test::Stages<Real> stages(builder.scene);
    for (std::uint32_t sample = 0; sample < 16; ++sample) {
        EXPECT_EQ(stages.generate(0, sample).time, Real(0.75));
    }
}

// --- Lobes, through the shading stage
// -------------------------------------------------------------------------------------

TYPED_TEST(SamplingTest, MixPicksTheMirrorWithItsProbability) {
    using Real = TypeParam;
    for (const double probability : {0.0, 0.3, 0.75, 1.0}) {
        test::SceneBuilder builder;
        builder.camera({0, 1, 0}, {1, 0, 0}).depth(2);
        builder.quad(builder.mix(Vec3d(0.25), Vec3d(0.5), probability), {0, 0, 0}, 10, 10);
        test::Stages<Real> stages(builder.scene);
        std::uint64_t mirrored = 0;
        Grid grid(16, 32);
        for (std::uint32_t sample = 0; sample < draws; ++sample) {
            Path<Real> path = stages.generate(0, sample);
            ASSERT_TRUE(stages.shade(path, stages.intersect(path)));
            if (path.throughput.x == Real(0.5)) {
                ++mirrored;
                ASSERT_NEAR(path.direction.x, std::sqrt(Real(0.5)), 1e-6);
                ASSERT_NEAR(path.direction.y, std::sqrt(Real(0.5)), 1e-6);
            } else {
                ASSERT_EQ(path.throughput.x, Real(0.25));
                grid.add(double(path.direction.y) * path.direction.y, turn_of(path.direction.x, path.direction.z));
            }
        }
        if (probability == 0 || probability == 1) {
            EXPECT_EQ(mirrored, probability == 0 ? 0u : static_cast<std::uint64_t>(draws));
        } else {
            EXPECT_GT(chi_square_test({mirrored, draws - mirrored}, {probability, 1 - probability}), chi_square_alpha);
        }
        if (probability < 1) {
            EXPECT_GT(grid.p_value(), chi_square_alpha);
        }
    }
}

TYPED_TEST(SamplingTest, DielectricReflectsInProportionToFresnel) {
    using Real = TypeParam;
    test::SceneBuilder builder;
    builder.camera({0, 0, -4}, {0, 0, 1}).depth(2);
    builder.box(builder.dielectric(1.5), {0, 0, 0}, Vec3d(2.0));
    test::Stages<Real> stages(builder.scene);
    std::uint64_t reflected = 0;
    for (std::uint32_t sample = 0; sample < draws; ++sample) {
        Path<Real> path = stages.generate(0, sample);
        ASSERT_TRUE(stages.shade(path, stages.intersect(path)));
        reflected += path.direction.z < 0 ? 1u : 0u;
    }
    EXPECT_GT(chi_square_test({reflected, draws - reflected}, {0.04, 0.96}), chi_square_alpha);
}

TYPED_TEST(SamplingTest, FreePathsAreExponential) {
    using Real = TypeParam;
    // Escape through a white slab of optical depth 1 without a collision: e^-1. Observed as straight passage.
    test::SceneBuilder builder;
    builder.camera({0, 0, -4}, {0, 0, 1}).depth(2);
    builder.box(builder.subsurface(Vec3d(0.5)), {0, 0, 0}, {1000, 1000, 2});
    test::Stages<Real> stages(builder.scene);
    std::uint64_t straight = 0;
    for (std::uint32_t sample = 0; sample < draws; ++sample) {
        Path<Real> path = stages.generate(0, sample);
        ASSERT_TRUE(stages.shade(path, stages.intersect(path)));
        straight += path.direction == Vec3<Real>(0, 0, 1) ? 1u : 0u;
    }
    const double exact = std::exp(-1.0);
    EXPECT_GT(chi_square_test({straight, draws - straight}, {exact, 1 - exact}), chi_square_alpha);
}

}  // namespace
}  // namespace pt
