// Polygons as triangles: who covers which point, held to the polygon's own crossing numbers.
#include "harness/mesh/triangulate.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace pt {
namespace {

using Point = std::array<float, 3>;
using Polygon = std::vector<Point>;
using Triangles = std::vector<std::array<std::uint32_t, 3>>;

Triangles fan_of(std::size_t corners) {
    Triangles fan;
    for (std::uint32_t i = 2; i < corners; ++i) {
        fan.push_back({0, i - 1, i});
    }
    return fan;
}

// With the fan where that is the answer.
Triangles triangles_of(const Polygon& polygon) {
    const PolygonTriangles found = triangulate(polygon);
    EXPECT_EQ(found.doubt, "");
    return found.triangles.empty() ? fan_of(polygon.size()) : found.triangles;
}

// Whether a point of the plane z = 0, which is on no edge, lies in a polygon, in double precision.
bool is_in(const Polygon& polygon, double x, double y) {
    bool inside = false;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Point &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
        if ((a[1] > y) != (b[1] > y) && x < a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0])) {
            inside = !inside;
        }
    }
    return inside;
}

double twice_area(const Point& a, const Point& b, const Point& c) {
    return (double{b[0]} - a[0]) * (double{c[1]} - a[1]) - (double{b[1]} - a[1]) * (double{c[0]} - a[0]);
}

// Every point of a grid lies in as many triangles as in the polygon, all of which go round anticlockwise.
void expect_covered_once(const Polygon& polygon, double side) {
    const Triangles triangles = triangles_of(polygon);
    ASSERT_EQ(triangles.size(), polygon.size() - 2);
    for (const auto& [a, b, c] : triangles) {
        EXPECT_GE(twice_area(polygon[a], polygon[b], polygon[c]), 0);
    }
    constexpr int points = 40;
    for (int i = 0; i < points * points; ++i) {
        // Off every line through whole numbers below 100.
        const double x = side * (i % points + 0.4142135) / points, y = side * (i / points + 0.7320508) / points;
        int count = 0;
        for (const auto& [a, b, c] : triangles) {
            count += is_in({polygon[a], polygon[b], polygon[c]}, x, y) ? 1 : 0;
        }
        EXPECT_EQ(count, is_in(polygon, x, y) ? 1 : 0) << x << ", " << y;
    }
}

TEST(TriangulateTest, WhatItsFanCoversIsTheFan) {
    for (const std::size_t corners : {3, 4, 5, 12, 100}) {
        Polygon round;
        for (std::size_t i = 0; i < corners; ++i) {
            const double angle = 2 * 3.14159265358979 * static_cast<double>(i) / static_cast<double>(corners);
            round.push_back({static_cast<float>(std::cos(angle)), 5, static_cast<float>(std::sin(angle))});
        }
        const PolygonTriangles found = triangulate(round);
        EXPECT_TRUE(found.triangles.empty()) << corners;
        EXPECT_EQ(found.doubt, "") << corners;
    }
    // A corner that is flat but for its rounding; and a dart whose first corner is the inner one.
    EXPECT_TRUE(triangulate(Polygon{{1, 0, 0}, {2, 1e-7f, 0}, {3, 0, 0}, {2, 2, 0}}).triangles.empty());
    EXPECT_TRUE(triangulate(Polygon{{1, 1, 0}, {0, 4, 0}, {0, 0, 0}, {4, 0, 0}}).triangles.empty());
    const PolygonTriangles nothing = triangulate(Polygon{{1, 1, 1}, {2, 2, 2}, {3, 3, 3}, {1, 1, 1}});
    EXPECT_TRUE(nothing.triangles.empty());
    EXPECT_EQ(nothing.doubt, "");
}

TEST(TriangulateTest, ADartIsCutFromWhicheverCornerOn) {
    Polygon dart{{0, 0, 0}, {4, 0, 0}, {1, 1, 0}, {0, 4, 0}};
    for (int turn = 0; turn < 4; ++turn) {
        double area = 0;
        for (const auto& [a, b, c] : triangles_of(dart)) {
            area += std::abs(twice_area(dart[a], dart[b], dart[c]));
        }
        EXPECT_EQ(area, 8);  // of its fan around a neighbour of the inner corner: 16
        std::rotate(dart.begin(), dart.begin() + 1, dart.end());
    }
}

TEST(TriangulateTest, CombsSpiralsAndHolesAreCoveredOnce) {
    Polygon comb{{20, 0, 0}, {20, 10, 0}};
    for (int tooth = 18; tooth >= 2; tooth -= 2) {
        comb.push_back({static_cast<float>(tooth), tooth % 4 == 0 ? 10.0f : 1.0f, 0});
    }
    comb.push_back({0, 10, 0});
    comb.push_back({0, 0, 0});
    expect_covered_once(comb, 20);
    expect_covered_once({{0, 0, 0},
                         {9, 0, 0},
                         {9, 9, 0},
                         {1, 9, 0},
                         {1, 3, 0},
                         {6, 3, 0},
                         {6, 6, 0},
                         {4, 6, 0},
                         {4, 5, 0},
                         {5, 5, 0},
                         {5, 4, 0},
                         {2, 4, 0},
                         {2, 8, 0},
                         {8, 8, 0},
                         {8, 1, 0},
                         {0, 1, 0}},
                        10);
    // A square with a square hole, which an edge there and back joins to the rim.
    expect_covered_once(
        {{0, 0, 0}, {9, 0, 0}, {9, 9, 0}, {0, 9, 0}, {0, 0, 0}, {3, 3, 0}, {3, 6, 0}, {6, 6, 0}, {6, 3, 0}, {3, 3, 0}},
        10);
    // Corners on a straight edge are kept: neighbours have them too.
    expect_covered_once({{4, 0, 0}, {4, 4, 0}, {2, 4, 0}, {2, 2, 0}, {1, 2, 0}, {0, 2, 0}, {0, 0, 0}, {2, 0, 0}}, 5);
}

TEST(TriangulateTest, RandomStarsAreCoveredOnce) {
    std::mt19937 random(42);
    for (int star = 0; star < 50; ++star) {
        Polygon polygon;
        const int corners = 5 + star % 16;
        for (int i = 0; i < corners; ++i) {
            const double angle = 2 * 3.14159265358979 * i / corners;
            const double radius = 2 + static_cast<double>(random() % 1000) / 50;
            polygon.push_back({static_cast<float>(25 + radius * std::cos(angle)),
                               static_cast<float>(25 + radius * std::sin(angle)), 0});
        }
        expect_covered_once(polygon, 50);
    }
}

TEST(TriangulateTest, InEveryPlaneAndFromBothSides) {
    const Polygon dart{{4, 0, 0}, {1, 1, 0}, {0, 4, 0}, {0, 0, 0}};
    const Triangles expected = triangulate(dart).triangles;
    ASSERT_EQ(expected.size(), 2u);
    for (int axis = 0; axis < 3; ++axis) {
        for (const float side : {1.0f, -1.0f}) {
            Polygon turned;
            for (const Point& p : dart) {
                Point corner{};
                corner[(axis + 1) % 3] = side * p[0];
                corner[(axis + 2) % 3] = p[1];
                corner[axis] = 7;
                turned.push_back(corner);
            }
            EXPECT_EQ(triangulate(turned).triangles, expected) << axis << " " << side;
        }
    }
}

TEST(TriangulateTest, WhatIsInDoubtIsTold) {
    const auto doubt = [](const Polygon& polygon) { return std::string(triangulate(polygon).doubt).substr(0, 35); };
    const std::string bent = "a polygon whose corners lie in no p", crossed = "a polygon whose edges cross each ot";
    EXPECT_EQ(doubt({{0, 0, 0}, {1, 0, 0}, {1, 1, 0.5f}, {0, 1, 0}}), bent);
    EXPECT_EQ(doubt({{0, 0, 0}, {1, 0, 0}, {1, 1, 0.01f}, {0, 1, 0}}), "");
    EXPECT_EQ(doubt({{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}}), crossed);
    EXPECT_EQ(doubt({{0, 0, 0}, {3, 1, 0}, {3, 0, 0}, {0, 2, 0}}), crossed);
    Polygon pentagram, twice_round;
    for (int i = 0; i < 10; ++i) {
        const double angle = 2 * 3.14159265358979 * i / 5;
        const Point corner{static_cast<float>(std::cos(2 * angle)), static_cast<float>(std::sin(2 * angle)), 0};
        if (i < 5) {
            pentagram.push_back(corner);
        }
        twice_round.push_back({static_cast<float>((1 + 0.1 * i) * std::cos(angle)),
                               static_cast<float>((1 + 0.1 * i) * std::sin(angle)), 0});
    }
    EXPECT_EQ(doubt(pentagram), crossed);
    EXPECT_EQ(doubt(twice_round), crossed);
    Polygon comb{{20000, -1, 0}};
    for (int i = 5000; i > 0; --i) {
        comb.push_back({static_cast<float>(4 * i), i % 2 == 0 ? 5.0f : 1.0f, 0});
    }
    comb.push_back({0, -1, 0});
    EXPECT_EQ(doubt(comb), "a polygon that is not cut into tria");
    EXPECT_TRUE(triangulate(comb).triangles.empty());
}

}  // namespace
}  // namespace pt
