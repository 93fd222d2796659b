// Directions towards lamps, drawn in every way of the axis light_sampling, against the density that connections and
// encounters are weighed by: counts over cells of what is seen, against that density's integral over each.
#include "kernels/light_direction.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "harness/scene/scene_buffers.h"
#include "tests/support/scenes.h"
#include "tests/support/statistics.h"

namespace pt {
namespace {

template <class Real>
using Everything = Config<Real, all_features>;

constexpr std::uint32_t draws = 50000;
constexpr int side = 8;  // cells along each side of a part
constexpr double alpha = 1e-6;

// A part of what is seen (a face, or all of a round lamp), and a place on it, from 0 to 1 along its sides.
struct Spot {
    int part;
    double s, t;
};
// From the observer to a spot; `solid_angle`: of the part, were all of it as it is there.
struct Aim {
    Vec3d direction;
    double distance, solid_angle;
};

Vec3d to_local(const Placement& lamp, const Vec3d& v) {
    return {dot(lamp.column[0], v), dot(lamp.column[1], v), dot(lamp.column[2], v)};
}
Vec3d to_world(const Placement& lamp, const Vec3d& v) {
    return lamp.column[0] * v.x + lamp.column[1] * v.y + lamp.column[2] * v.z;
}

// The faces of a box, or the one of a quad, that are seen from outside.
struct Faces {
    Placement lamp;
    Vec3d observer, half;  // in the lamp's frame
    std::vector<int> across;

    Faces(const Placement& placed, const Vec3d& from, const Vec3d& extents)
        : lamp(placed), observer(from), half(extents) {
        for (int axis = 0; axis < 3; ++axis) {
            if (std::abs(observer[axis]) > half[axis] && half[(axis + 1) % 3] * half[(axis + 2) % 3] > 0) {
                across.push_back(axis);
            }
        }
    }
    int parts() const { return static_cast<int>(across.size()); }
    double to_plane(int axis) const { return std::copysign(half[axis], observer[axis]) - observer[axis]; }
    Aim aim(const Spot& spot) const {
        const int a = across[static_cast<std::size_t>(spot.part)], b = (a + 1) % 3, c = (a + 2) % 3;
        Vec3d to;
        to[a] = to_plane(a);
        to[b] = (2 * spot.s - 1) * half[b] - observer[b];
        to[c] = (2 * spot.t - 1) * half[c] - observer[c];
        const double distance = std::sqrt(dot(to, to));
        const double seen_area = 4 * half[b] * half[c] * std::abs(to[a]) / distance;
        return {to_world(lamp, to) / distance, distance, seen_area / (distance * distance)};
    }
    // On the seen face whose plane the ray crosses last.
    Spot spot(const Vec3d& world) const {
        const Vec3d direction = to_local(lamp, world);
        Spot spot{-1, 0, 0};
        double last = 0;
        for (int part = 0; part < parts(); ++part) {
            const int a = across[static_cast<std::size_t>(part)], b = (a + 1) % 3, c = (a + 2) % 3;
            const double distance = to_plane(a) / direction[a];
            if (distance > last) {
                last = distance;
                spot = {part, 0.5 + 0.5 * (observer[b] + distance * direction[b]) / half[b],
                        0.5 + 0.5 * (observer[c] + distance * direction[c]) / half[c]};
            }
        }
        return spot;
    }
};

// A round lamp, which fills a cone in the frame in which it is the unit sphere; from within a lamp, all directions.
struct Cap {
    Placement lamp;
    Vec3d half;
    Frame<double> frame;
    double height;  // 1 - cosine of the cone's angle

    Cap(const Placement& placed, const Vec3d& from, const Vec3d& extents)
        : lamp(placed), half(extents), frame(normalize(-from / half)) {
        const double square = dot(from / half, from / half);
        height = square > 1 ? 1 - std::sqrt(1 - 1 / square) : 2;
    }
    static int parts() { return 1; }
    Aim aim(const Spot& spot) const {
        const double z = 1 - spot.s * height, flat = std::sqrt(1 - z * z), turn = 2 * pi<double> * spot.t;
        const Vec3d to = half * frame.to_world({flat * std::cos(turn), flat * std::sin(turn), z});
        const double length = std::sqrt(dot(to, to));
        const double stretch = half.x * half.y * half.z / (length * length * length);  // of solid angles by the frame
        return {to_world(lamp, to) / length, 1, 2 * pi<double> * height * stretch};
    }
    Spot spot(const Vec3d& world) const {
        const Vec3d direction = normalize(to_local(lamp, world) / half);
        const double turn = std::atan2(dot(direction, frame.bitangent), dot(direction, frame.tangent)) / pi<double>;
        return {0, (1 - dot(direction, frame.normal)) / height, turn < 0 ? 1 + 0.5 * turn : 0.5 * turn};
    }
};

// The least p-value of all tests; and those of counts by face together (Fisher), to which all that picks faces adds.
struct Tests {
    int count = 0, by_face = 0;
    double least = 1, fisher = 0;
    std::string what;

    void take(double p_value, const std::string& of) {
        count += 1;
        what = p_value < least ? of : what;
        least = std::min(least, p_value);
    }
};

// The probability of a cell, by 8 x 8 points of Gauss and Legendre; the lamp is the scene's only object.
template <class Real, class Sky>
double probability_of(const Sky& sky, const SceneView<Real>& scene, const Vec3d& from, int cell) {
    constexpr double nodes[] = {-0.9602898564975363, -0.7966664774136267, -0.5255324099163290, -0.1834346424956498,
                                0.1834346424956498,  0.5255324099163290,  0.7966664774136267,  0.9602898564975363};
    constexpr double weights[] = {0.1012285362903763, 0.2223810344533745, 0.3137066458778873, 0.3626837833783620,
                                  0.3626837833783620, 0.3137066458778873, 0.2223810344533745, 0.1012285362903763};
    double sum = 0;
    for (int node = 0; node < 64; ++node) {
        const Aim aim = sky.aim({cell / (side * side), (cell / side % side + 0.5 + 0.5 * nodes[node / 8]) / side,
                                 (cell % side + 0.5 + 0.5 * nodes[node % 8]) / side});
        const Real inverse_pdf = inverse_direction_pdf_to<Everything<Real>>(
            scene, {static_cast<Real>(aim.distance), SurfaceId::of(0, false)},
            {Vec3<Real>(from), Vec3<Real>(aim.direction), Real(0), {}});
        sum += 0.25 * weights[node / 8] * weights[node % 8] * aim.solid_angle / static_cast<double>(inverse_pdf);
    }
    return sum / (side * side);
}

// Rounding takes a direction to an edge past it; -1: it is beyond that.
int cell_of(const Spot& spot) {
    const auto place = [](double s) { return std::clamp(static_cast<int>(s * side), 0, side - 1); };
    const double off_centre = std::max(std::abs(spot.s - 0.5), std::abs(spot.t - 0.5));
    return spot.part < 0 || !(off_centre < 0.5001) ? -1 : (spot.part * side + place(spot.s)) * side + place(spot.t);
}

template <class Real, class Sky>
void draw_over(const Sky& sky, const SceneView<Real>& scene, const Vec3d& from, const std::string& what, Tests& tests) {
    const auto parts = static_cast<std::size_t>(sky.parts());
    std::vector<double> expected(parts * side * side), by_part(parts);
    for (std::size_t i = 0; i < expected.size(); ++i) {
        expected[i] = probability_of(sky, scene, from, static_cast<int>(i));
        EXPECT_GE(expected[i] * draws, 10) << what;
        by_part[i / (side * side)] += expected[i];
    }
    // Four times the points move no cell by more than 1.1e-4 of its count's standard deviation; the rest is rounding.
    EXPECT_NEAR(std::accumulate(by_part.begin(), by_part.end(), 0.0), 1, 2e-6) << what;
    std::vector<std::uint64_t> counts(expected.size()), counts_by_part(parts);
    for (std::uint32_t i = 0; i < draws; ++i) {
        const RandomWords words = pcg4d({i, static_cast<std::uint32_t>(tests.count), 1, random_block::light});
        const DirectionSample<Real> sample =
            sample_direction_to<Everything<Real>>(scene, 0, Vec3<Real>(from), Real(0), unit_interval<Real>(words.y),
                                                  unit_interval<Real>(words.z), unit_interval<Real>(words.w));
        const int cell = cell_of(sky.spot(Vec3d(sample.direction)));
        ASSERT_GE(cell, 0) << what;
        counts[static_cast<std::size_t>(cell)] += 1;
        counts_by_part[static_cast<std::size_t>(cell / (side * side))] += 1;
    }
    tests.take(test::chi_square_test(counts, expected), what);
    if (parts > 1) {
        // A face's share that is a little off is lost in the noise of many cells.
        const double p_value = test::chi_square_test(counts_by_part, by_part);
        tests.take(p_value, what + ", by face");
        tests.by_face += 1;
        tests.fisher -= 2 * std::log(std::max(p_value, 1e-300));
    }
}

struct Lamp {
    const char* name;
    Shape shape;
    Vec3d size, turn;
    std::vector<Vec3d> places;  // in its frame
};
// Far from three faces and from one; near three, one, one within its edge, two, three at their corner; inside, or close
// to a quad. Half a diagonal is 1.15: near is within 0.8 of the box (auto), or 4.6 of its centre (solid_angle).
const std::vector<Vec3d> about_a_box = {{3, 2, 5},          {0.3, 6, -0.2},    {2, 1.5, 1.1},      {0.3, 0.5, -0.2},
                                        {-0.95, 0.45, 0.1}, {1.25, 0.45, 0.1}, {1.2, -0.4, -0.65}, {0.3, 0.1, -0.2}};
// Far, near, all but on a sphere, and inside.
const std::vector<Vec3d> about_a_ball = {{3, 2, 5}, {0.3, 0.72, -0.2}, {0.05, 0.752, -0.02}, {0.3, 0.1, -0.2}};
const Lamp lamps[] = {{"box", Shape::box, {2, 0.5, 1}, {0, 0, 0}, about_a_box},
                      {"turned box", Shape::box, {2, 0.5, 1}, {20, 30, 40}, about_a_box},
                      {"quad", Shape::quad, {2, 0, 1}, {20, 30, 40}, about_a_box},
                      {"sphere", Shape::sphere, {1.5, 1.5, 1.5}, {0, 0, 0}, about_a_ball},
                      {"ellipsoid", Shape::sphere, {3, 0.75, 1.5}, {20, 30, 40}, about_a_ball}};

template <class Real>
void draw_lamp(const Lamp& lamp, LightSampling way, const std::string& what, Tests& tests) {
    test::SceneBuilder builder;
    SceneObject& object = builder.box(builder.emitter({1, 1, 1}), {0.5, -0.25, 2}, lamp.size, lamp.turn);
    object.shape = lamp.shape;
    const Placement placement = placement_of(object, {0, 0, 0});
    RenderSettings settings = default_settings(builder.scene);
    settings.next_event = true;
    settings.light_sampling = way;
    settings.near_light = 70;  // what the variant has unless it is tuned
    const SceneBuffers<Real> buffers(builder.scene, settings);
    for (const Vec3d& place : lamp.places) {
        const std::string name = what + std::to_string(&place - lamp.places.data());
        const Vec3d from = placement.centre + to_world(placement, place);
        const Faces faces(placement, place, lamp.size * 0.5);
        if (lamp.shape != Shape::sphere && faces.parts() > 0) {
            draw_over(faces, buffers.view(), from, name, tests);
        } else {
            const Vec3d extents = lamp.shape == Shape::sphere ? lamp.size * 0.5 : Vec3d(1.0);
            draw_over(Cap(placement, place, extents), buffers.view(), from, name, tests);
        }
    }
}

template <class Real>
class LightSamplingChiSquareTest : public testing::Test {};
using Reals = testing::Types<float, double>;
TYPED_TEST_SUITE(LightSamplingChiSquareTest, Reals);

TYPED_TEST(LightSamplingChiSquareTest, DirectionsAreDrawnByTheirDensity) {
    Tests tests;
    for (const Lamp& lamp : lamps) {
        const std::string name = lamp.name;
        draw_lamp<TypeParam>(lamp, LightSampling::solid_angle, name + ", solid_angle, place ", tests);
        draw_lamp<TypeParam>(lamp, LightSampling::area, name + ", area, place ", tests);
        draw_lamp<TypeParam>(lamp, LightSampling::projected, name + ", projected, place ", tests);
        draw_lamp<TypeParam>(lamp, LightSampling::automatic, name + ", auto, place ", tests);
    }
    EXPECT_GT(tests.count, 150);
    EXPECT_GE(tests.least * tests.count, alpha) << tests.what;  // Bonferroni
    EXPECT_GE(test::chi_square_p_value(tests.fisher, 2 * tests.by_face), alpha);
}

}  // namespace
}  // namespace pt
