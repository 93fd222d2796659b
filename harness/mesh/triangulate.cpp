#include "harness/mesh/triangulate.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace pt {

namespace {

// Tolerances for polygons that were convex or flat before their corners were rounded to single precision.
constexpr double slight_area = 0x1p-16;
constexpr double slight_height = 0.01;      // largest bend of a polygon over its size that looks alike however split
constexpr std::size_t most_corners = 4096;  // most polygon corners for the quadratic test for crossing edges
constexpr std::uint64_t most_looks = std::uint64_t{1} << 28;  // limit on tests whether a corner lies in an ear

constexpr std::string_view not_flat = "a polygon whose corners lie in no plane: which way it is bent is not said";
constexpr std::string_view crosses =
    "a polygon whose edges cross each other: it is shown as the fan around its first "
    "corner";
constexpr std::string_view too_involved =
    "a polygon that is not cut into triangles (concave, and more than 4096 corners "
    "or edges that overlap): it is shown as the fan around its first corner";

double cross(const glm::dvec2& a, const glm::dvec2& b) { return a.x * b.y - a.y * b.x; }

// Twice the signed area of a triangle, positive if its corners are anticlockwise.
double turn(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) { return cross(b - a, c - a); }

struct FanFacts {
    glm::dvec3 normal{0.0};  // polygon normal by Newell's method, of length twice the area
    double covered = 0;      // twice the summed area of the fan's triangles around the polygon's first corner
    double backward = 0;     // twice the summed area of those fan triangles that face against the normal
    double angle = 0;        // sum of the fan triangles' angles at the polygon's first corner
    double size = 0;         // distance from the polygon's first corner to the farthest
    double height = 0;       // extent of the polygon along its normal
};

FanFacts facts_of_fan(const std::vector<glm::dvec3>& from_first) {
    FanFacts facts;
    const std::size_t count = from_first.size();
    for (std::size_t i = 2; i < count; ++i) {
        facts.normal += glm::cross(from_first[i - 1], from_first[i]);
    }
    const double length = glm::length(facts.normal);
    const glm::dvec3 unit = length > 0 ? facts.normal / length : glm::dvec3(0.0);
    double low = 0, high = 0;
    for (std::size_t i = 1; i < count; ++i) {
        const double above = glm::dot(from_first[i], unit);
        low = std::min(low, above);
        high = std::max(high, above);
        facts.size = std::max(facts.size, glm::length(from_first[i]));
        if (i > 1) {
            const glm::dvec3 across = glm::cross(from_first[i - 1], from_first[i]);
            const double area = glm::dot(across, unit);
            facts.covered += glm::length(across);
            facts.backward += std::max(0.0, -area);
            facts.angle += count > 4 ? std::atan2(area, glm::dot(from_first[i - 1], from_first[i])) : 0;
        }
    }
    facts.height = high - low;
    return facts;
}

// Projects a polygon along the axis closest to its normal, so that its corners are anticlockwise in the plane.
std::vector<glm::dvec2> projected(const std::vector<glm::dvec3>& corners, const glm::dvec3& normal) {
    int axis = 0;
    for (int i = 1; i < 3; ++i) {
        axis = std::abs(normal[i]) > std::abs(normal[axis]) ? i : axis;
    }
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    std::vector<glm::dvec2> flat;
    for (const glm::dvec3& corner : corners) {
        flat.push_back(normal[axis] > 0 ? glm::dvec2(corner[u], corner[v]) : glm::dvec2(corner[v], corner[u]));
    }
    return flat;
}

// Whether any two edges of a polygon cross; touching does not count.
bool edges_cross(const std::vector<glm::dvec2>& corners) {
    const std::size_t count = corners.size();
    const auto parts = [](double a, double b) { return (a > 0 && b < 0) || (a < 0 && b > 0); };
    for (std::size_t i = 0; i < count; ++i) {
        const glm::dvec2 &a = corners[i], &b = corners[(i + 1) % count];
        for (std::size_t j = i + 2; j < count; ++j) {
            const glm::dvec2 &c = corners[j], &d = corners[(j + 1) % count];
            if (parts(turn(a, b, c), turn(a, b, d)) && parts(turn(c, d, a), turn(c, d, b))) {
                return true;
            }
        }
    }
    return false;
}

class EarCutter {
public:
    explicit EarCutter(const std::vector<glm::dvec2>& corners) : corners_(corners) {
        for (std::size_t i = 0; i < corners.size(); ++i) {
            before_.push_back((i + corners.size() - 1) % corners.size());
            after_.push_back((i + 1) % corners.size());
        }
    }

    // Triangulates the polygon by cutting ears. Empty if no ear was found or the limit on tests was reached.
    std::vector<std::array<std::uint32_t, 3>> cut() {
        std::size_t at = 0;
        for (std::size_t left = corners_.size(); left > 2; --left) {
            const std::optional<std::size_t> ear = next_ear(at, left);
            if (!ear) {
                return {};
            }
            const std::size_t last = before_[*ear], next = after_[*ear];
            triangles_.push_back(
                {static_cast<std::uint32_t>(last), static_cast<std::uint32_t>(*ear), static_cast<std::uint32_t>(next)});
            after_[last] = next;
            before_[next] = last;
            at = next;
        }
        return std::move(triangles_);
    }

private:
    // Order in which ears are cut. Flat ears come last: cutting one leaves a vertex in the middle of a remaining edge.
    enum class Ear { clear, touched, flat };

    std::optional<std::size_t> next_ear(std::size_t from, std::size_t left) {
        for (const Ear kind : {Ear::clear, Ear::touched, Ear::flat}) {
            std::size_t at = from;
            for (std::size_t i = 0; i < left; ++i, at = after_[at]) {
                if (looks_ > most_looks) {
                    return std::nullopt;
                }
                if (is_ear(at, kind)) {
                    return at;
                }
            }
        }
        return std::nullopt;
    }

    bool is_ear(std::size_t at, Ear kind) {
        const glm::dvec2 &a = corners_[before_[at]], &b = corners_[at], &c = corners_[after_[at]];
        const double area = turn(a, b, c);
        if (kind == Ear::flat || !(area > 0)) {
            return kind == Ear::flat && area == 0;
        }
        for (std::size_t other = after_[after_[at]]; other != before_[at]; other = after_[other]) {
            looks_ += 1;
            const glm::dvec2& p = corners_[other];
            if (p == a || p == b || p == c) {
                continue;
            }
            const double least = std::min({turn(a, b, p), turn(b, c, p), turn(c, a, p)});
            if (least > 0 || (least == 0 && kind == Ear::clear)) {
                return false;
            }
        }
        return true;
    }

    const std::vector<glm::dvec2>& corners_;
    std::vector<std::size_t> before_, after_;
    std::vector<std::array<std::uint32_t, 3>> triangles_;
    std::uint64_t looks_ = 0;
};

}  // namespace

PolygonTriangles triangulate(std::span<const std::array<float, 3>> corners) {
    if (corners.size() < 4) {
        return {};
    }
    std::vector<glm::dvec3> from_first;
    for (const std::array<float, 3>& corner : corners) {
        from_first.emplace_back(double{corner[0]} - corners[0][0], double{corner[1]} - corners[0][1],
                                double{corner[2]} - corners[0][2]);
    }
    const FanFacts fan = facts_of_fan(from_first);
    if (!(glm::length(fan.normal) > slight_area * fan.covered)) {
        return {.triangles = {}, .doubt = fan.covered > 0 ? crosses : ""};
    }
    const std::string_view bent = fan.height > slight_height * fan.size ? not_flat : "";
    if (fan.backward <= slight_area * fan.covered && fan.angle < 2 * std::numbers::pi) {
        return {.triangles = {}, .doubt = bent};
    }
    if (corners.size() > most_corners) {
        return {.triangles = {}, .doubt = too_involved};
    }
    const std::vector<glm::dvec2> flat = projected(from_first, fan.normal);
    if (edges_cross(flat)) {
        return {.triangles = {}, .doubt = crosses};
    }
    PolygonTriangles cut{.triangles = EarCutter(flat).cut(), .doubt = bent};
    if (cut.triangles.empty()) {
        cut.doubt = too_involved;
    }
    return cut;
}

}  // namespace pt
