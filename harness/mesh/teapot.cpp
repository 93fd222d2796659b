// The Utah teapot of Martin Newell (The Utilization of Procedure Models in Digital Image Synthesis, 1975, University of
// Utah): 32 bicubic Bezier patches. 24 are quarters of nearly round bodies and computed from profiles.
#include <span>

#include "harness/mesh/check_mesh.h"
#include "harness/mesh/exact_math.h"
#include "harness/mesh/generators.h"

namespace pt {

namespace {

// A row of control points on a quarter circle from x to y: (r, 0), (r, s), (s, r), (0, r), all at one height.
struct RoundRow {
    double r, height, s;
};
constexpr double newell_share = 0.56;  // Newell's ratio s / r of control points; 0.5523 is nearer to a quarter circle
constexpr RoundRow round_row(double r, double height) { return {r, height, newell_share * r}; }

// Profiles of the teapot's round bodies, from the top down so that patches face outward. Adjacent patches share a row.
constexpr RoundRow rim_and_body[] = {round_row(1.4, 2.4),  round_row(1.3375, 2.53125), round_row(1.4375, 2.53125),
                                     round_row(1.5, 2.4),  round_row(1.75, 1.875),     round_row(2.0, 1.35),
                                     round_row(2.0, 0.9),  round_row(2.0, 0.45),       round_row(1.5, 0.225),
                                     round_row(1.5, 0.15), round_row(1.5, 0.075),      round_row(1.425, 0.0),
                                     round_row(0.0, 0.0)};
constexpr RoundRow lid[] = {round_row(0.0, 3.15), {0.8, 3.15, 0.45},    round_row(0.0, 2.85), round_row(0.2, 2.7),
                            round_row(0.4, 2.55), round_row(1.3, 2.55), round_row(1.3, 2.4)};

// Control points on half a cross section of a handle or spout: (x, 0), (x, w), (x', w), (x', 0) at z, z, z', z'.
struct PipeRow {
    double x, z, far_x, far_z, width;
};
constexpr PipeRow handle[] = {{-1.6, 2.025, -1.5, 2.25, 0.3}, {-2.3, 2.025, -2.5, 2.25, 0.3},
                              {-2.7, 2.025, -3.0, 2.25, 0.3}, {-2.7, 1.8, -3.0, 1.8, 0.3},
                              {-2.7, 1.575, -3.0, 1.35, 0.3}, {-2.5, 1.125, -2.65, 0.9375, 0.3},
                              {-2.0, 0.9, -1.9, 0.6, 0.3}};
constexpr PipeRow spout[] = {{1.7, 1.425, 1.7, 0.6, 0.66},       {2.6, 1.425, 3.1, 0.825, 0.66},
                             {2.3, 2.1, 2.4, 2.025, 0.25},       {2.7, 2.4, 3.3, 2.4, 0.25},
                             {2.8, 2.475, 3.525, 2.49375, 0.25}, {2.9, 2.475, 3.45, 2.5125, 0.15},
                             {2.8, 2.4, 3.2, 2.4, 0.15}};

using PatchRow = std::array<glm::dvec3, 4>;
using Patch = std::array<PatchRow, 4>;

// Interpolates between two points, exact at both ends and for equal points, so that patches have bit-identical borders.
glm::dvec3 between(const glm::dvec3& a, const glm::dvec3& b, double t) { return a == b ? a : (1.0 - t) * a + t * b; }

// Evaluates a cubic Bezier curve by De Casteljau's algorithm.
glm::dvec3 on_curve(const PatchRow& points, double t) {
    const glm::dvec3 a = between(points[0], points[1], t), b = between(points[1], points[2], t);
    const glm::dvec3 c = between(points[2], points[3], t);
    return between(between(a, b, t), between(b, c, t), t);
}

// Adds a Bezier patch of n x n x 2 triangles. Newell's z axis is up, which becomes y.
void add_patch(Mesh& mesh, const Patch& patch, std::uint32_t n) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (std::uint32_t i = 0; i <= n; ++i) {
        for (std::uint32_t j = 0; j <= n; ++j) {
            const double u = static_cast<double>(i) / n, v = static_cast<double>(j) / n;
            const glm::dvec3 point = on_curve(
                {on_curve(patch[0], v), on_curve(patch[1], v), on_curve(patch[2], v), on_curve(patch[3], v)}, u);
            mesh.vertices.push_back(in_single({point.x, point.z, 0.0 - point.y}));
        }
    }
    for (std::uint32_t i = 0; i < n; ++i) {
        for (std::uint32_t j = 0; j < n; ++j) {
            const std::uint32_t a = first + i * (n + 1) + j, b = a + 1, c = a + n + 1, d = c + 1;
            mesh.triangles.push_back({a, c, b});
            mesh.triangles.push_back({b, c, d});
        }
    }
}

PatchRow quarter(const RoundRow& row, int turns) {
    PatchRow points{glm::dvec3(row.r, 0, row.height), glm::dvec3(row.r, row.s, row.height),
                    glm::dvec3(row.s, row.r, row.height), glm::dvec3(0, row.r, row.height)};
    for (glm::dvec3& point : points) {
        for (int i = 0; i < turns; ++i) {
            point = {0.0 - point.y, point.x, point.z};
        }
    }
    return points;
}

// Control points on one half of a cross section of a handle or spout, ordered so that the patch faces outward.
PatchRow half(const PipeRow& row, bool is_mirrored) {
    const double y = is_mirrored ? row.width : -row.width;
    const PatchRow points{glm::dvec3(row.x, 0, row.z), glm::dvec3(row.x, y, row.z), glm::dvec3(row.far_x, y, row.far_z),
                          glm::dvec3(row.far_x, 0, row.far_z)};
    return is_mirrored ? points : PatchRow{points[3], points[2], points[1], points[0]};
}

void add_round(Mesh& mesh, std::span<const RoundRow> rows, std::uint32_t n) {
    for (std::size_t row = 0; row + 3 < rows.size(); row += 3) {
        for (int turns = 0; turns < 4; ++turns) {
            add_patch(mesh,
                      {quarter(rows[row], turns), quarter(rows[row + 1], turns), quarter(rows[row + 2], turns),
                       quarter(rows[row + 3], turns)},
                      n);
        }
    }
}

void add_pipe(Mesh& mesh, std::span<const PipeRow> rows, std::uint32_t n) {
    for (std::size_t row = 0; row + 3 < rows.size(); row += 3) {
        for (const bool mirrored : {false, true}) {
            add_patch(mesh,
                      {half(rows[row], mirrored), half(rows[row + 1], mirrored), half(rows[row + 2], mirrored),
                       half(rows[row + 3], mirrored)},
                      n);
        }
    }
}

}  // namespace

Mesh make_teapot(std::uint32_t n) {
    Mesh mesh;
    mesh.vertices.reserve(std::size_t{32} * (n + 1) * (n + 1));
    mesh.triangles.reserve(std::size_t{64} * n * n);
    add_round(mesh, rim_and_body, n);
    add_round(mesh, lid, n);
    add_pipe(mesh, handle, n);
    add_pipe(mesh, spout, n);
    leave_out_degenerate(mesh);
    return mesh;
}

Mesh make_stadium(std::uint32_t n) {
    constexpr float half_side = 326'250.0f;  // half the side of the quad under the teapot: 10^5 / 2 times 6.525
    Mesh mesh = make_teapot(n);
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (const auto& [x, z] : {std::pair{-1.0f, -1.0f}, {-1.0f, 1.0f}, {1.0f, 1.0f}, {1.0f, -1.0f}}) {
        mesh.vertices.push_back({x * half_side, 0.0f, z * half_side});
    }
    mesh.triangles.push_back({first, first + 1, first + 2});
    mesh.triangles.push_back({first, first + 2, first + 3});
    return mesh;
}

}  // namespace pt
