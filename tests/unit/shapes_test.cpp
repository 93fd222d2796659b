// Every shape of the list (kernels/shape_list.h): what it says of its size against the points that it gives, and of
// densities against the directions.
#include <algorithm>
#include <cmath>
#include <set>
#include <type_traits>
#include <vector>

#include <gtest/gtest.h>

#include "harness/scene/scene_buffers.h"
#include "kernels/visit_shape.h"
#include "tests/support/random_vectors.h"
#include "tests/support/scenes.h"
#include "variants/descriptor.h"

namespace pt::test {
namespace {

// Calls check(shape) for an object of every kind: placed off the origin, stretched and turned as far as the kind
// allows.
template <class Real, class Check>
void for_each_shape(const Check& check) {
    for (const bool turned : {false, true}) {
        for (const Vec3d& scale : {Vec3d(1.5), Vec3d(1, 2, 3)}) {
            const Vec3d turn = turned ? Vec3d(20, 30, 40) : Vec3d(90, 0, 180);
            for (const std::string& name : shape_names()) {
                if (shape_named(name) == Shape::mesh) {
                    continue;  // no shape without its triangles: tests/image/mesh_test.cpp
                }
                const SceneObject object{
                    .shape = shape_named(name), .translate = {1, -2, 3}, .rotate_degrees = turn, .scale = scale};
                const Placement placement = placement_of(object, {0.5, 0, 0});
                switch (classify(object)) {
#define PT_CHECK(name, array, Type)                            \
    case ShapeKind::name: {                                    \
        SCOPED_TRACE(#name);                                   \
        check(Type<Real>::placed(placement), ShapeKind::name); \
        break;                                                 \
    }
                    PT_SHAPES(PT_CHECK)
#undef PT_CHECK
                }
            }
        }
    }
}

template <class Real>
class ShapesTest : public testing::Test {};
using Reals = testing::Types<float, double>;
TYPED_TEST_SUITE(ShapesTest, Reals);

template <class Shape>
concept HasArea = requires(const Shape& shape) {
    area_of(shape);
};

TYPED_TEST(ShapesTest, BoundsAreTightAroundItsPoints) {
    using Real = TypeParam;
    std::set<ShapeKind> seen;
    for_each_shape<Real>([&](const auto& shape, ShapeKind kind) {
        seen.insert(kind);
        const Bounds<Real> bounds = bounds_of(shape);
        const Real slack = Real(64) * unit_round_off<Real>;
        Random random(1);
        Vec3<Real> low(Real(100)), high(Real(-100));
        const auto unit = [&] { return static_cast<Real>(random.word() >> 8) * Real(0x1p-24); };
        for (int i = 0; i < 20000; ++i) {
            const LightSample<Real> sample = sample_point(shape, unit(), unit(), unit());
            for (int axis = 0; axis < 3; ++axis) {
                low[axis] = min(low[axis], sample.position[axis]);
                high[axis] = max(high[axis], sample.position[axis]);
            }
        }
        Real widest = Real(0);
        for (int axis = 0; axis < 3; ++axis) {
            ASSERT_GE(low[axis], bounds.low[axis] - slack);
            ASSERT_LE(high[axis], bounds.high[axis] + slack);
            // 20,000 points come this near to every side.
            ASSERT_LE(low[axis], bounds.low[axis] + Real(0.15));
            ASSERT_GE(high[axis], bounds.high[axis] - Real(0.15));
            widest = max(widest, bounds.high[axis] - bounds.low[axis]);
        }
        // The largest half extent: no more than half the diagonal of the box, no less than half of its half.
        ASSERT_LE(size_of(shape), widest * Real(0.87));
        ASSERT_GE(size_of(shape), widest * Real(0.25));
    });
    EXPECT_EQ(seen.size(), shape_count - 1);  // all but meshes, or the test would say nothing of some
}

// Where a shape names its area, its points are uniform: one density, one over the area.
TYPED_TEST(ShapesTest, AreaIsWhatPointsAreDrawnBy) {
    using Real = TypeParam;
    int with_area = 0;
    for_each_shape<Real>([&](const auto& shape, ShapeKind) {
        if constexpr (HasArea<std::decay_t<decltype(shape)>>) {
            with_area += 1;
            const Real area = area_of(shape);
            for (const Real u : {Real(0.25), Real(0.75)}) {
                ASSERT_NEAR(sample_point(shape, u, u, u).inverse_density, area, area * 8 * unit_round_off<Real>);
            }
        }
    });
    EXPECT_GT(with_area, 4);
}

// What next-event estimation falls back on is right for every shape that says its area: the mean of 1 / density is the
// solid angle that its own sampling finds.
TYPED_TEST(ShapesTest, SamplingByAreaFindsTheSolidAngle) {
    using Real = TypeParam;
    for_each_shape<Real>([&](const auto& shape, ShapeKind) {
        if constexpr (HasArea<std::decay_t<decltype(shape)>>) {
            const Bounds<Real> bounds = bounds_of(shape);
            const Vec3<Real> observer = bounds.high + (bounds.high - bounds.low) * Real(0.6) + Vec3<Real>(Real(0.5));
            Random random(2);
            const auto unit = [&] { return static_cast<Real>(random.word() >> 8) * Real(0x1p-24); };
            Mean by_area, by_angle;
            for (int i = 0; i < 40000; ++i) {
                const Vec3<Real> to_point = sample_point(shape, unit(), unit(), unit()).position - observer;
                const Real distance = square_root(dot(to_point, to_point));
                by_area.add(inverse_pdf_by_area(shape, observer, to_point * (Real(1) / distance), distance));
                // A direction of a far box may pass it by: then its weight is for nothing.
                const DirectionSample<Real> sample = sample_direction(shape, observer, unit(), unit(), unit());
                by_angle.add(interval(shape, observer, sample.direction).hits ? sample.inverse_pdf : Real(0));
            }
            EXPECT_NEAR(by_area.value(), by_angle.value(),
                        5 * std::hypot(by_area.standard_error(), by_angle.standard_error()) + 1e-3 * by_angle.value());
        }
    });
}

TEST(ShapeListTest, EveryKindIsAFeatureOfItsName) {
    const std::vector<std::string> names = feature_names(shape_features);
    std::vector<std::string> expected;
#define PT_NAME(name, array, Type) expected.emplace_back(#name);
    PT_SHAPES(PT_NAME)
#undef PT_NAME
    EXPECT_EQ(names, expected);
    EXPECT_EQ(std::popcount(shape_features), static_cast<int>(shape_count));
}

TEST(ShapeListTest, FilesHaveThreeNamesForTheFirstFive) {
    const std::vector<std::string> names = shape_names();
    ASSERT_GE(names.size(), 3u);
    EXPECT_EQ(names[0], "sphere");
    EXPECT_EQ(names[1], "box");
    EXPECT_EQ(names[2], "quad");
    EXPECT_EQ(shape_named("box"), Shape::box);
    EXPECT_EQ(name_of(Shape::quad), "quad");
}

// P-value of directions over the cap that holds the shape's box, against the density that they are said to have, summed
// over cells of equal solid angle. Cells that the shape does not fill count as one.
template <class Real, class Shape, class Draw, class InversePdf>
double directions_p_value(const Shape& shape, const Vec3<Real>& observer, const Draw& draw,
                          const InversePdf& inverse_pdf) {
    constexpr int rows = 24, columns = 48, parts = 8, draws = 40000;
    const Bounds<Real> bounds = bounds_of(shape);
    const Vec3d to_centre = (Vec3d(bounds.low) + Vec3d(bounds.high)) * 0.5 - Vec3d(observer);
    const Vec3d half = (Vec3d(bounds.high) - Vec3d(bounds.low)) * 0.5;
    const double cap = 1 - std::sqrt(1 - dot(half, half) / dot(to_centre, to_centre));
    const Frame<double> frame(normalize(to_centre));
    std::vector<double> probabilities{0};  // the first is that of the cells that are not filled
    std::vector<std::size_t> number(rows * columns, 0);
    double sum = 0;
    for (int cell = 0; cell < rows * columns; ++cell) {
        double probability = 0;
        int met_by = 0;
        for (int part = 0; part < parts * parts; ++part) {
            const double row = cell / columns + (part / parts + 0.5) / parts;
            const double column = cell % columns + (part % parts + 0.5) / parts;
            const double z = 1 - cap * row / rows, flat = std::sqrt(1 - z * z),
                         turn = 2 * pi<double> * column / columns;
            const Vec3<Real> direction(frame.to_world({flat * std::cos(turn), flat * std::sin(turn), z}));
            const Interval<Real> met = interval(shape, observer, direction);
            if (met.hits) {
                const double area = 2 * pi<double> * cap / (rows * columns * parts * parts);
                probability += area / static_cast<double>(inverse_pdf(direction, met.near));
                met_by += 1;
            }
        }
        if (met_by == parts * parts) {
            number[static_cast<std::size_t>(cell)] = probabilities.size();
            probabilities.push_back(probability);
        } else {
            probabilities[0] += probability;
        }
        sum += probability;
    }
    EXPECT_GT(probabilities.size(), 20u);
    // Parts on the outline count whole or not at all.
    EXPECT_NEAR(sum, 1, 0.01);
    probabilities[0] += 1 - sum;
    std::vector<std::uint64_t> counts(probabilities.size());
    for (int i = 0; i < draws; ++i) {
        const Vec3d direction(draw());
        const double turn = std::atan2(dot(direction, frame.bitangent), dot(direction, frame.tangent));
        const int row = static_cast<int>((1 - dot(direction, frame.normal)) / cap * rows);
        const int column = static_cast<int>((turn / (2 * pi<double>)+1) * columns) % columns;
        counts[number[static_cast<std::size_t>(std::clamp(row, 0, rows - 1) * columns + column)]] += 1;
    }
    return chi_square_test(counts, probabilities);
}

TYPED_TEST(ShapesTest, DirectionsFollowTheirDensity) {
    using Real = TypeParam;
    int boxes = 0;
    for_each_shape<Real>([&](const auto& shape, ShapeKind) {
        using Shape = std::decay_t<decltype(shape)>;
        if constexpr (!std::is_same_v<Shape, MeshInstance<Real>>) {
            const Bounds<Real> bounds = bounds_of(shape);
            const Vec3<Real> size = bounds.high - bounds.low;
            const Vec3<Real> observer = (bounds.low + bounds.high) * Real(0.5) +
                                        Vec3<Real>(Real(0.5), Real(0.6), Real(0.7)) * square_root(dot(size, size));
            Random random(5);
            const auto unit = [&] { return static_cast<Real>(random.word() >> 8) * Real(0x1p-24); };
            EXPECT_GT(directions_p_value<Real>(
                          shape, observer,
                          [&] { return sample_direction(shape, observer, unit(), unit(), unit()).direction; },
                          [&](const Vec3<Real>& direction, Real distance) {
                              return inverse_direction_pdf(shape, observer, direction, distance);
                          }),
                      chi_square_alpha);
            if constexpr (IsBoxLike<Shape, Real>) {
                for (const LightSampling sampling :
                     {LightSampling::area, LightSampling::projected, LightSampling::automatic}) {
                    boxes += 1;
                    // Near is nearer than two and a half half diagonals.
                    const Real near_light = Real(2.5);
                    EXPECT_GT(directions_p_value<Real>(
                                  shape, observer,
                                  [&] {
                                      return sample_box_light(shape, observer, sampling, near_light, unit(), unit(),
                                                              unit())
                                          .direction;
                                  },
                                  [&](const Vec3<Real>& direction, Real distance) {
                                      return inverse_box_light_pdf(shape, observer, direction, distance, sampling,
                                                                   near_light);
                                  }),
                              chi_square_alpha)
                        << static_cast<int>(sampling);
                }
            }
        }
    });
    EXPECT_GT(boxes, 8);
}

}  // namespace
}  // namespace pt::test
