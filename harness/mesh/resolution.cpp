#include "harness/mesh/resolution.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

namespace pt {

namespace {

constexpr double slight_of_extent = 0x1p-14, slight_of_edge = 0x1p-7;

struct Extents {
    double low[3], high[3];
    double side = 0;  // largest side of the mesh's bounding box
};

Extents extents_of(const Mesh& mesh) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    Extents extents{{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}};
    for (const std::array<float, 3>& vertex : mesh.vertices) {
        for (int axis = 0; axis < 3; ++axis) {
            extents.low[axis] = std::min(extents.low[axis], double{vertex[axis]});
            extents.high[axis] = std::max(extents.high[axis], double{vertex[axis]});
        }
    }
    for (int axis = 0; axis < 3; ++axis) {
        extents.side = std::max(extents.side, extents.high[axis] - extents.low[axis]);
    }
    return extents;
}

double mean_edge_of(const Mesh& mesh) {
    double sum = 0;
    for (const std::array<std::uint32_t, 3>& triangle : mesh.triangles) {
        for (int i = 0; i < 3; ++i) {
            const auto &a = mesh.vertices[triangle[i]], &b = mesh.vertices[triangle[(i + 1) % 3]];
            const double x = double{a[0]} - b[0], y = double{a[1]} - b[1], z = double{a[2]} - b[2];
            sum += std::sqrt(x * x + y * y + z * z);
        }
    }
    return mesh.triangles.empty() ? 0 : sum / (3 * static_cast<double>(mesh.triangles.size()));
}

// Origin to suggest for a mesh far from zero: the middle of its extent, rounded to a power of ten near its size.
double origin_of(double low, double high, double side) {
    const double unit = std::pow(10.0, std::floor(std::log10(side)));
    return std::round(0.5 * (low + high) / unit) * unit + 0.0;
}

}  // namespace

void RoundingLoss::add(const std::array<double, 3>& exact, const std::array<float, 3>& rounded, std::size_t place) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (const double loss = std::abs(exact[axis] - double{rounded[axis]}); loss > largest_) {
            largest_ = loss;
            place_ = place;
        }
    }
}

std::optional<std::string> resolution_warning(const Mesh& mesh, double largest) {
    const Extents extents = extents_of(mesh);
    if (!(largest > 0) || !(extents.side > 0) || !std::isfinite(extents.side)) {
        return std::nullopt;
    }
    const double edge = mean_edge_of(mesh);
    if (largest <= slight_of_extent * extents.side && largest <= slight_of_edge * edge) {
        return std::nullopt;
    }
    const auto origin = [&](int axis) { return origin_of(extents.low[axis], extents.high[axis], extents.side); };
    return fmt::format(
        "coordinates with more digits than single precision has: vertices are moved by up to {:.2g}, of a mesh {:.3g} "
        "across whose edges are {:.2g} long on average; take an origin such as ({:.10g}, {:.10g}, {:.10g}) from them, "
        "and give it to the object as its \"translate\"",
        largest, extents.side, edge, origin(0), origin(1), origin(2));
}

bool may_have_lost_digits(const Mesh& mesh) {
    const Extents extents = extents_of(mesh);
    double largest = 0;
    for (int axis = 0; axis < 3; ++axis) {
        largest = std::max({largest, std::abs(extents.low[axis]), std::abs(extents.high[axis])});
    }
    return resolution_warning(mesh, std::ldexp(largest, -24)).has_value();
}

}  // namespace pt
