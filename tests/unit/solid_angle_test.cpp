// Directions towards lights: they meet the light, their densities are what they are drawn by, and what is integrated
// with them is known in closed form.
#include "kernels/solid_angle.h"
#include "kernels/scene_view.h"

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <glm/common.hpp>

#include "tests/support/statistics.h"

namespace pt {
namespace {

using Vec3d = Vec3<double>;

constexpr std::uint32_t samples = 40000;

template <class Real>
Vec3<Real> narrow(const Vec3d& v) {
    return {static_cast<Real>(v.x), static_cast<Real>(v.y), static_cast<Real>(v.z)};
}

// Rotation of the columns of a frame by three angles.
struct Axes {
    Vec3d column[3];
};
Axes turned(double a, double b, double c) {
    const auto turn = [](Vec3d v, int axis, double angle) {
        const int i = (axis + 1) % 3, j = (axis + 2) % 3;
        const double x = v[i] * std::cos(angle) - v[j] * std::sin(angle);
        v[j] = v[i] * std::sin(angle) + v[j] * std::cos(angle);
        v[i] = x;
        return v;
    };
    Axes axes{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    for (Vec3d& column : axes.column) {
        column = turn(turn(turn(column, 0, a), 1, b), 2, c);
    }
    return axes;
}

// Lambert's formula: the vector irradiance (integral of the direction over the solid angle) of a polygon, whose corners
// are given relative to the observer, counter-clockwise as the observer sees it.
Vec3d vector_irradiance(const std::vector<Vec3d>& corners) {
    Vec3d sum(0.0);
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const Vec3d a = normalize(corners[i]), b = normalize(corners[(i + 1) % corners.size()]);
        const Vec3d across = cross(a, b);
        const double sine = std::sqrt(dot(across, across));
        sum += across * (0.5 * std::atan2(sine, dot(a, b)) / sine);
    }
    return sum;
}

// Van Oosterom and Strackee 1983, of a triangle.
double solid_angle(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
    const double x = std::sqrt(dot(a, a)), y = std::sqrt(dot(b, b)), z = std::sqrt(dot(c, c));
    return 2 * std::atan2(std::abs(dot(a, cross(b, c))), x * y * z + dot(a, b) * z + dot(a, c) * y + dot(b, c) * x);
}

struct Seen {
    double solid_angle = 0;
    Vec3d irradiance{0.0};
};

// The faces of a box (half extents h, in its own frame) that the observer outside of it sees.
Seen seen_box(const Vec3d& observer, const Vec3d& h) {
    Seen seen;
    for (int axis = 0; axis < 3; ++axis) {
        const int b = (axis + 1) % 3, c = (axis + 2) % 3;
        if (std::abs(observer[axis]) <= h[axis] || h[b] == 0 || h[c] == 0) {
            continue;
        }
        std::vector<Vec3d> corners;
        for (const auto& [s, t] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) {
            Vec3d corner;
            corner[axis] = observer[axis] > 0 ? h[axis] : -h[axis];
            corner[b] = s * h[b];
            corner[c] = t * h[c];
            corners.push_back(corner - observer);
        }
        const Vec3d towards = corners[0] + corners[2];
        Vec3d irradiance = vector_irradiance(corners);
        seen.irradiance += dot(irradiance, towards) > 0 ? irradiance : -irradiance;
        seen.solid_angle +=
            solid_angle(corners[0], corners[1], corners[2]) + solid_angle(corners[0], corners[2], corners[3]);
    }
    return seen;
}

// How a body is sampled: by its own functions, or as a box that is drawn otherwise.
struct BySolidAngle {
    double least_gap = 0;
    template <class Body, class Real>
    DirectionSample<Real> sample(const Body& body, const Vec3<Real>& from, Real u, Real v, Real w) const {
        return sample_direction(body, from, u, v, w);
    }
    template <class Body, class Real>
    Real inverse_pdf(const Body& body, const Vec3<Real>& from, const Vec3<Real>& direction, Real distance) const {
        return inverse_direction_pdf(body, from, direction, distance);
    }
};
struct AsBoxLight {
    LightSampling sampling;
    double near_light = 0;
    double least_gap = 0;  // nearer to a box the weights have so large a variance that means say nothing

    template <class Body, class Real>
    DirectionSample<Real> sample(const Body& body, const Vec3<Real>& from, Real u, Real v, Real w) const {
        return sample_box_light(body, from, sampling, static_cast<Real>(near_light), u, v, w);
    }
    template <class Body, class Real>
    Real inverse_pdf(const Body& body, const Vec3<Real>& from, const Vec3<Real>& direction, Real distance) const {
        return inverse_box_light_pdf(body, from, direction, distance, sampling, static_cast<Real>(near_light));
    }
};
// The ways that a box may be drawn.
const std::pair<const char*, AsBoxLight> box_lights[] = {
    {"area", {LightSampling::area, 0, 0.1}},
    {"projected", {LightSampling::projected, 0, 0.1}},
    {"auto, mostly near", {LightSampling::automatic, 10}},
    {"auto", {LightSampling::automatic, 0.9}},
};

// Draws directions; `distance` is the way to the body, negative where a direction misses it.
template <class Real, class Body, class Way = BySolidAngle>
void expect_sampled(const Body& body, const Vec3d& observer, const Seen& exact,
                    const std::function<double(const Vec3<Real>& direction)>& distance, const std::string& what,
                    double error_of_exact = 0, const Way& way = {}) {
    test::Random random(29);
    test::Mean of_one, of_direction[3];
    std::uint32_t missed = 0;
    std::uint32_t other_density = 0;
    constexpr double rounding_of_density =
        (sizeof(Real) == 4 ? 1e-4 : 1e-11) * (std::is_same_v<Way, BySolidAngle> ? 1 : 100);
    const Vec3<Real> from = narrow<Real>(observer);
    for (std::uint32_t i = 0; i < samples; ++i) {
        const DirectionSample<Real> sample =
            way.sample(body, from, static_cast<Real>(random.word() >> 8) * Real(0x1p-24),
                       static_cast<Real>(random.word() >> 8) * Real(0x1p-24),
                       static_cast<Real>(random.word() >> 8) * Real(0x1p-24));
        const Vec3d direction(sample.direction);
        ASSERT_NEAR(dot(direction, direction), 1, sizeof(Real) == 4 ? 2e-6 : 1e-14) << what;
        const double t = distance(sample.direction);
        missed += t < 0 ? 1 : 0;
        if (t >= 0) {
            const double again = way.inverse_pdf(body, from, sample.direction, static_cast<Real>(t));
            // A density that depends on where the ray ends differs by the rounding of that end, as a cube; by that of
            // points on a face, seen at a thousandth of its length, by a thousand times as much.
            const double off = std::abs(again / static_cast<double>(sample.inverse_pdf) - 1);
            other_density += off < rounding_of_density ? 0 : 1;
        }
        const double weight = t < 0 ? 0 : static_cast<double>(sample.inverse_pdf);
        of_one.add(weight);
        for (int c = 0; c < 3; ++c) {
            of_direction[c].add(weight * direction[c]);
        }
    }
    // A density may jump at an edge between faces, on either side of which rounding may put the end of the ray.
    EXPECT_LE(other_density, (std::is_same_v<Way, BySolidAngle> ? 0 : samples / 1000)) << what;
    // Rounding takes directions to the very edge past it: one in the number of roundings across the body.
    EXPECT_LT(missed, samples / 1000) << what;
    const double rounding = std::max(sizeof(Real) == 4 ? 2e-4 : 1e-9, error_of_exact) * exact.solid_angle;
    EXPECT_NEAR(of_one.value(), exact.solid_angle, test::tolerated_errors * of_one.standard_error() + rounding) << what;
    for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(of_direction[c].value(), exact.irradiance[c],
                    test::tolerated_errors * of_direction[c].standard_error() + rounding)
            << what << " " << c;
    }
}

template <class Real>
class SolidAngleTest : public testing::Test {};
using Reals = testing::Types<float, double>;
TYPED_TEST_SUITE(SolidAngleTest, Reals);

TYPED_TEST(SolidAngleTest, ArcTangentIsTheStandardLibrarys) {
    using Real = TypeParam;
    const double unit = sizeof(Real) == 4 ? 0x1p-24 : 0x1p-53;
    for (int i = -4000; i <= 4000; ++i) {
        const Real x = static_cast<Real>(std::sinh(i * 0.005));
        const double exact = std::atan(static_cast<double>(x));
        EXPECT_NEAR(static_cast<double>(arc_tangent(x)), exact, 4 * unit * std::abs(exact)) << x;
        EXPECT_EQ(arc_tangent(-x), -arc_tangent(x));
    }
    EXPECT_EQ(arc_tangent(Real(0)), Real(0));
    EXPECT_EQ(arc_tangent(std::numeric_limits<Real>::infinity()), pi<Real> / 2);
}

TYPED_TEST(SolidAngleTest, SineAndCosineOfAnAngle) {
    using Real = TypeParam;
    const double unit = sizeof(Real) == 4 ? 0x1p-24 : 0x1p-53;
    for (int i = -1000; i <= 1000; ++i) {
        const Real x = static_cast<Real>(i * 0.00628);
        const SinCos<Real> both = sin_cos(x);
        // The turn is rounded twice before it is reduced.
        const double allowed = 4 * unit * (1 + std::abs(static_cast<double>(x)));
        EXPECT_NEAR(static_cast<double>(both.sine), std::sin(static_cast<double>(x)), allowed) << x;
        EXPECT_NEAR(static_cast<double>(both.cosine), std::cos(static_cast<double>(x)), allowed) << x;
    }
}

TYPED_TEST(SolidAngleTest, Sphere) {
    using Real = TypeParam;
    const Vec3d centre{0.5, -0.25, 2};
    for (const double radius : {1.0, 0.125, 1e-3}) {
        for (const double height : {1e-3, 0.5, 20.0}) {
            const Vec3d away = normalize(Vec3d(0.3, 0.8, -0.5));
            const Sphere<Real> sphere{narrow<Real>(centre), static_cast<Real>(radius), static_cast<Real>(1 / radius)};
            // The geometry is that of the rounded numbers.
            const Vec3d from(narrow<Real>(centre + away * (radius * (1 + height))));
            const Vec3d apart = from - Vec3d(sphere.centre);
            const double distance = std::sqrt(dot(apart, apart));
            const double ratio = static_cast<double>(sphere.radius) / distance;
            const double squared = ratio * ratio;
            const Seen exact{2 * pi<double> * squared / (1 + std::sqrt(1 - squared)),
                             apart * (-pi<double> * squared / distance)};
            expect_sampled<Real>(
                sphere, from, exact,
                [&](const Vec3<Real>& direction) {
                    const Interval<Real> crossing = interval(sphere, narrow<Real>(from), direction);
                    return crossing.hits ? static_cast<double>(crossing.near) : -1.0;
                },
                "sphere " + std::to_string(radius) + " height " + std::to_string(height));
        }
    }
    const Sphere<Real> around{narrow<Real>(centre), Real(1), Real(1)};
    expect_sampled<Real>(
        around, centre + Vec3d(0.3, 0.2, 0.6), {4 * pi<double>, Vec3d(0.0)}, [](const auto&) { return 1.0; }, "inside");
    expect_sampled<Real>(
        around, centre, {4 * pi<double>, Vec3d(0.0)}, [](const auto&) { return 1.0; }, "at the centre");
}

// Against a sum over a grid of directions. Its error is in the cells that the outline crosses: about the root of their
// number, of 4.5 million cells in all.
TYPED_TEST(SolidAngleTest, Ellipsoid) {
    using Real = TypeParam;
    const Axes axes = turned(0.3, 0.7, 1.1);
    const Vec3d centre{0.5, -0.25, 2};
    for (const Vec3d& size : {Vec3d(0.5, 0.5, 0.5), Vec3d(1.5, 0.2, 0.6)}) {
        Ellipsoid<Real> body;
        body.centre = narrow<Real>(centre);
        for (int axis = 0; axis < 3; ++axis) {
            body.semi_axis[axis] = narrow<Real>(axes.column[axis] * size[axis]);
            body.inverse_axis[axis] = narrow<Real>(axes.column[axis] * (1 / size[axis]));
        }
        for (const Vec3d& away : {Vec3d(0.9, 0.5, -1.4), Vec3d(0.2, 0.8, 0.1), Vec3d(0.05, -0.1, 0.02)}) {
            const auto distance = [&](const Vec3<Real>& direction) {
                const Interval<Real> crossing = interval(body, narrow<Real>(centre + away), direction);
                return crossing.hits && crossing.far > 0 ? std::max(0.0, static_cast<double>(crossing.near)) : -1.0;
            };
            Seen exact;
            constexpr int rows = 1500, columns = 3000;
            for (int row = 0; row < rows; ++row) {
                for (int column = 0; column < columns; ++column) {
                    const double z = (row + 0.5) * 2 / rows - 1;
                    const double angle = (column + 0.5) * 2 * pi<double> / columns;
                    const double flat = std::sqrt(1 - z * z);
                    const Vec3d direction{flat * std::cos(angle), flat * std::sin(angle), z};
                    if (distance(narrow<Real>(direction)) >= 0) {
                        const double area = 4 * pi<double> / rows / columns;
                        exact.solid_angle += area;
                        exact.irradiance += direction * area;
                    }
                }
            }
            expect_sampled<Real>(body, centre + away, exact, distance, "ellipsoid", 5e-4);
        }
    }
}

template <class Real, class Way>
void expect_boxes_sampled(const std::string& name, const Way& way) {
    const Axes axes = turned(0.4, 0.2, 0.9);
    const Vec3d centre{0.5, -0.25, 2};
    // Near and far, over a face, an edge and a corner, almost in a face's plane.
    const Vec3d places[] = {{0.3, 0.75, -0.2}, {2, 1.5, 0.1},      {3, 2, 5},      {20, 1, 3},
                            {0.2, 40, 9},      {1.0005, 0, 0.125}, {1.5, 0.251, 0}};
    for (const Vec3d& half : {Vec3d(1, 0.25, 0.5), Vec3d(1, 0, 0.5)}) {
        for (const Vec3d& place : places) {
            const Vec3d beyond = glm::max(Vec3d(0.0), glm::abs(place) - half);
            if (std::sqrt(dot(beyond, beyond)) < way.least_gap) {
                continue;
            }
            const Seen local = seen_box(place, half);
            const std::string what = name + ": box of height " + std::to_string(half.y) + " from " +
                                     std::to_string(place.x) + " " + std::to_string(place.y) + " " +
                                     std::to_string(place.z);
            if (half.y > 0) {
                const AxisBox<Real> straight{narrow<Real>(centre - half), narrow<Real>(centre + half)};
                const Vec3<Real> from = narrow<Real>(centre + place);
                expect_sampled<Real>(
                    straight, centre + place, local,
                    [&](const Vec3<Real>& d) {
                        const Interval<Real> crossing = slab_interval(straight.low, straight.high, from, reciprocal(d));
                        return crossing.hits && crossing.near > 0 ? static_cast<double>(crossing.near) : -1.0;
                    },
                    what, 0, way);
            }
            const auto to_world = [&](const Vec3d& v) {
                return axes.column[0] * v.x + axes.column[1] * v.y + axes.column[2] * v.z;
            };
            const Seen turned_seen{local.solid_angle, to_world(local.irradiance)};
            const Vec3<Real> from = narrow<Real>(centre + to_world(place));
            if (half.y > 0) {
                const OrientedBox<Real> turned_box{
                    narrow<Real>(centre),
                    {narrow<Real>(axes.column[0]), narrow<Real>(axes.column[1]), narrow<Real>(axes.column[2])},
                    narrow<Real>(half)};
                expect_sampled<Real>(
                    turned_box, centre + to_world(place), turned_seen,
                    [&](const Vec3<Real>& d) {
                        const Interval<Real> crossing = interval(turned_box, from, d);
                        return crossing.hits && crossing.near > 0 ? static_cast<double>(crossing.near) : -1.0;
                    },
                    "oriented " + what, 0, way);
            } else if (place.y != 0) {
                const Quad<Real> quad{narrow<Real>(centre),         narrow<Real>(axes.column[1]),
                                      narrow<Real>(axes.column[0]), narrow<Real>(axes.column[2]),
                                      static_cast<Real>(half.x),    static_cast<Real>(half.z)};
                expect_sampled<Real>(
                    quad, centre + to_world(place), turned_seen,
                    [&](const Vec3<Real>& d) {
                        const Interval<Real> crossing = interval(quad, from, d);
                        return crossing.hits && crossing.near > 0 ? static_cast<double>(crossing.near) : -1.0;
                    },
                    "quad, " + what, 0, way);
            }
        }
        const AxisBox<Real> around{narrow<Real>(centre - half), narrow<Real>(centre + half)};
        if (half.y > 0) {
            expect_sampled<Real>(
                around, centre + Vec3d(0.3, 0.2, -0.4), {4 * pi<double>, Vec3d(0.0)}, [](const auto&) { return 1.0; },
                name + ": inside", 0, way);
        }
    }
}

TYPED_TEST(SolidAngleTest, Boxes) { expect_boxes_sampled<TypeParam>("solid_angle", BySolidAngle{}); }
TYPED_TEST(SolidAngleTest, BoxesInOtherWays) {
    for (const auto& [name, way] : box_lights) {
        expect_boxes_sampled<TypeParam>(name, way);
    }
}

// A rectangle as NearRectangle draws it, however flat it is seen: weights have its solid angle as their mean, stay
// below 2 pi and are those of the point's direction; and v of a line's share lies below the point that v draws.
TYPED_TEST(SolidAngleTest, RectanglesThatMayBeNear) {
    using Real = TypeParam;
    const double rounding = sizeof(Real) == 4 ? 2e-5 : 1e-11;
    test::Random random(7);
    const auto sine = [](double y, double x, double z) { return y / std::sqrt(x * x + y * y + z * z); };
    for (int i = 0; i < 300; ++i) {
        const Real half_x = static_cast<Real>(random.uniform(0.005, 0.5)),
                   half_y = half_x + static_cast<Real>(random.uniform(0, 0.5));
        const Real at_x = static_cast<Real>(random.uniform(-1, 1)), at_y = static_cast<Real>(random.uniform(-1, 1));
        const Real z = static_cast<Real>(std::pow(10.0, random.uniform(-3, 0.5)));
        const NearRectangle<Real> rectangle(half_x, half_y, at_x, at_y, z);
        const auto x0 = static_cast<double>(rectangle.x0), x1 = static_cast<double>(rectangle.x1),
                   y0 = static_cast<double>(rectangle.y0), y1 = static_cast<double>(rectangle.y1);
        const SphericalRectangle<double> exact(x0, x1, y0, y1, static_cast<double>(z));
        constexpr int points = 4000;  // close to both ends, where weights rise if a rectangle is seen flat
        double mean = 0;
        for (int k = 0; k < points; ++k) {
            const auto v = static_cast<Real>(random.uniform(0.001, 0.999));
            const double turn = pi<double> * (k + 0.5) / points;
            const auto [point, inverse_pdf] = rectangle.sample(static_cast<Real>(0.5 - 0.5 * std::cos(turn)), v);
            mean += static_cast<double>(inverse_pdf) * std::sin(turn) * pi<double> / 2 / points;
            ASSERT_LE(static_cast<double>(inverse_pdf), 2 * pi<double> * (1 + rounding));
            const auto length = std::sqrt(dot(Vec3d(point), Vec3d(point)));
            const Vec3<Real> direction = narrow<Real>(Vec3d(point) / length);
            EXPECT_NEAR(static_cast<double>(rectangle.inverse_pdf(direction.x, direction.z) / inverse_pdf), 1, 0.01);
            const auto x = static_cast<double>(point.x), y = static_cast<double>(point.y);
            const double low = sine(y0, x, static_cast<double>(z)), high = sine(y1, x, static_cast<double>(z));
            EXPECT_NEAR((sine(y, x, static_cast<double>(z)) - low) / (high - low), static_cast<double>(v),
                        20 * rounding);
        }
        // A rounding of u moves a point that is seen at a thousandth by a thousand roundings.
        EXPECT_NEAR(mean / exact.solid_angle, 1, 1e-5 + 10 * rounding) << x0 << " " << y0 << " " << z;
    }
}

// The density of what is drawn integrates to 1 over the directions in which the box is seen: by a grid over its faces,
// whose points fill a solid angle of area cos / distance^2.
TYPED_TEST(SolidAngleTest, DensitiesOfBoxLightsIntegrateToOne) {
    using Real = TypeParam;
    const Vec3<Real> half{Real(1), Real(0.25), Real(0.5)};
    const AxisBox<Real> box{-half, half};
    const Vec3d places[] = {{0.3, 0.75, -0.2}, {2, 1.5, 0.1}, {3, 2, 5}, {1.2, 0, 0.125}, {1.5, 0.4, -0.7}};
    constexpr int cells = 400;
    for (const auto& [name, way] : box_lights) {
        for (const Vec3d& place : places) {
            double sum = 0;
            for (int axis = 0; axis < 3; ++axis) {
                const int b = (axis + 1) % 3, c = (axis + 2) % 3;
                const double height = std::abs(place[axis]) - static_cast<double>(half[axis]);
                const double area = 4.0 * static_cast<double>(half[b]) * static_cast<double>(half[c]) / cells / cells;
                for (int i = 0; height > 0 && i < cells * cells; ++i) {
                    Vec3d point;
                    point[axis] = std::copysign(static_cast<double>(half[axis]), place[axis]);
                    point[b] = (2 * (i % cells + 0.5) / cells - 1) * static_cast<double>(half[b]);
                    point[c] = (2 * (i / cells + 0.5) / cells - 1) * static_cast<double>(half[c]);
                    const Vec3d apart = point - place;
                    const double distance = std::sqrt(dot(apart, apart));
                    const Vec3<Real> direction = narrow<Real>(apart * (1 / distance));
                    const Real inverse_pdf =
                        way.inverse_pdf(box, narrow<Real>(place), direction, static_cast<Real>(distance));
                    sum += area * height / (distance * distance * distance) / static_cast<double>(inverse_pdf);
                }
            }
            EXPECT_NEAR(sum, 1, 1e-3) << name << " " << place.x << " " << place.y << " " << place.z;
        }
    }
}

// However near a face is, the weight of a direction by its solid angle stays below 6 pi: half the sky a face, of three.
TYPED_TEST(SolidAngleTest, WeightsNearABoxAreBounded) {
    using Real = TypeParam;
    const AxisBox<Real> box{Vec3<Real>(Real(-1), Real(-0.25), Real(-0.5)), Vec3<Real>(Real(1), Real(0.25), Real(0.5))};
    test::Random random(11);
    double largest = 0;
    for (int i = 0; i < 20000; ++i) {
        const double gap = std::pow(10.0, random.uniform(-7, -0.5));
        const Vec3<Real> from = narrow<Real>(Vec3d(random.uniform(-1.1, 1.1), 0.25 + gap, random.uniform(-0.6, 0.6)));
        const auto sample =
            sample_box_light(box, from, LightSampling::automatic, Real(1e3), static_cast<Real>(random.uniform(0, 1)),
                             static_cast<Real>(random.uniform(0, 1)), static_cast<Real>(random.uniform(0, 1)));
        largest = std::max(largest, static_cast<double>(sample.inverse_pdf));
    }
    EXPECT_LT(largest, 6 * pi<double> * 1.001);
    EXPECT_GT(largest, 6);
}

// From its own plane a quad is a line: there is nothing to sample, and nothing that is not a number.
TYPED_TEST(SolidAngleTest, QuadFromItsOwnPlane) {
    using Real = TypeParam;
    const Quad<Real> quad{{Real(0), Real(0), Real(0)},
                          {Real(0), Real(1), Real(0)},
                          {Real(1), Real(0), Real(0)},
                          {Real(0), Real(0), Real(1)},
                          Real(1),
                          Real(2)};
    for (const Vec3<Real>& observer : {Vec3<Real>(3, 0, 0), Vec3<Real>(30, 0, 7)}) {
        const DirectionSample<Real> sample = sample_direction(quad, observer, Real(0.3), Real(0.6), Real(0.9));
        EXPECT_EQ(sample.inverse_pdf, Real(0));
        for (const auto& [name, way] : box_lights) {
            EXPECT_EQ(way.sample(quad, observer, Real(0.3), Real(0.6), Real(0.9)).inverse_pdf, Real(0)) << name;
        }
    }
}

// Threads and needles, seen from their ends and from all over: whatever is drawn is a direction with a density, and a
// density is a number. A corner of such a rectangle lies nearer to the observer than its square can say.
TYPED_TEST(SolidAngleTest, BoxesOfExtremeSidesHaveDensities) {
    using Real = TypeParam;
    const auto expect_numbers = [](const AxisBox<Real>& box, const Vec3<Real>& from, const std::string& what) {
        for (const auto& [name, way] : box_lights) {
            const DirectionSample<Real> sample = way.sample(box, from, Real(0.3), Real(0.6), Real(0.9));
            ASSERT_TRUE(sample.inverse_pdf >= Real(0) && std::isfinite(sample.inverse_pdf)) << name << what;
            if (sample.inverse_pdf > Real(0)) {
                ASSERT_NEAR(static_cast<double>(dot(sample.direction, sample.direction)), 1, 2e-6) << name << what;
            }
            for (int axis = 0; axis < 3; ++axis) {
                Vec3<Real> direction(Real(0));
                direction[axis] = from[axis] > Real(0) ? Real(-1) : Real(1);
                const Real met = way.inverse_pdf(box, from, direction, max(Real(1e-30), absolute(from[axis])));
                ASSERT_TRUE(met >= Real(0)) << name << what;
            }
        }
    };
    const Real long_side = Real(1e18), thin = Real(1e-3);
    expect_numbers({{-long_side, Real(0), -thin}, {long_side, Real(0), thin}}, {long_side, Real(1e-12), thin},
                   " a thread from its end");
    test::Random random(23);
    const double sides[] = {0, 1e-18, 1e-12, 1e-6, 1e-3, 1, 1e3, 1e9, 1e18};
    const double gaps[] = {-2, -1, -0.5, 0, 1e-40, 1e-25, 1e-20, 1e-7, 0.1, 3};
    const auto one_of = [&](const auto& of) {
        return of[static_cast<std::size_t>(random.uniform(0, static_cast<double>(std::size(of))))];
    };
    for (int i = 0; i < 40000; ++i) {
        const Vec3d half{one_of(sides), one_of(sides), one_of(sides)};
        if (half.x + half.y + half.z == 0) {
            continue;
        }
        Vec3d from;
        for (int axis = 0; axis < 3; ++axis) {
            from[axis] = (random.uniform(0, 1) < 0.5 ? -1 : 1) *
                         (half[axis] + one_of(gaps) * (random.uniform(0, 1) < 0.5 ? half[axis] : one_of(sides)));
        }
        expect_numbers({narrow<Real>(-half), narrow<Real>(half)}, narrow<Real>(from),
                       " sides " + std::to_string(half.x) + " " + std::to_string(half.y) + " " +
                           std::to_string(half.z) + " from " + std::to_string(from.x) + " " + std::to_string(from.y) +
                           " " + std::to_string(from.z));
    }
}

// 2^k times the scene: the same directions and densities, bit for bit.
TYPED_TEST(SolidAngleTest, ScaleDoesNotMatter) {
    using Real = TypeParam;
    for (const int k : {-40, 30}) {
        const Real s = static_cast<Real>(std::ldexp(1.0, k));
        for (const double far : {1.5, 12.0}) {
            const Vec3<Real> observer{static_cast<Real>(far), Real(0.75), Real(2)};
            const auto same = [&](const auto& body, const auto& scaled) {
                const auto a = sample_direction(body, observer, Real(0.3), Real(0.6), Real(0.9));
                const auto b = sample_direction(scaled, observer * s, Real(0.3), Real(0.6), Real(0.9));
                EXPECT_EQ(a.direction, b.direction) << k;
                EXPECT_EQ(a.inverse_pdf, b.inverse_pdf) << k;
                if constexpr (IsBoxLike<std::decay_t<decltype(body)>, Real>) {
                    for (const auto& [name, way] : box_lights) {
                        const auto c = way.sample(body, observer, Real(0.3), Real(0.6), Real(0.9));
                        const auto d = way.sample(scaled, observer * s, Real(0.3), Real(0.6), Real(0.9));
                        EXPECT_EQ(c.direction, d.direction) << name << k;
                        EXPECT_EQ(c.inverse_pdf, d.inverse_pdf) << name << k;
                    }
                }
            };
            same(Sphere<Real>{Vec3<Real>(0, 0, 1), Real(0.75), Real(1) / Real(0.75)},
                 Sphere<Real>{Vec3<Real>(0, 0, 1) * s, Real(0.75) * s, Real(1) / (Real(0.75) * s)});
            same(AxisBox<Real>{Vec3<Real>(-1, -2, 0), Vec3<Real>(1, 0, 1)},
                 AxisBox<Real>{Vec3<Real>(-1, -2, 0) * s, Vec3<Real>(1, 0, 1) * s});
            same(Quad<Real>{Vec3<Real>(0, 0, 1), Vec3<Real>(0, 1, 0), Vec3<Real>(1, 0, 0), Vec3<Real>(0, 0, 1), Real(1),
                            Real(2)},
                 Quad<Real>{Vec3<Real>(0, 0, 1) * s, Vec3<Real>(0, 1, 0), Vec3<Real>(1, 0, 0), Vec3<Real>(0, 0, 1), s,
                            Real(2) * s});
        }
    }
}

}  // namespace
}  // namespace pt
