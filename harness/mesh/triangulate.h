// Polygons of mesh files as triangles.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "harness/mesh/mesh.h"

namespace pt {

// A polygon is the fan around its first corner wherever that covers it, as every convex one; else its ears are cut off
// (Meisters 1975), edges that touch allowed, so that holes may be bridged. Triangles go round as the polygon does.
struct PolygonTriangles {
    // The triangles as numbers of the polygon's corners, two fewer than it has; empty: the fan.
    std::vector<std::array<std::uint32_t, 3>> triangles;
    // Why the surface may be another than was meant; empty where nothing is in doubt.
    std::string_view doubt;
};

// Triangulates a polygon of at least three corners, all finite.
PolygonTriangles triangulate(std::span<const std::array<float, 3>> corners);

// The polygon's triangles in the place of its fan, which `fan` holds. What belongs to its corners, such as indices.
template <class T>
void replace_fan(std::span<std::array<T, 3>> fan, std::span<const std::array<std::uint32_t, 3>> triangles) {
    std::vector<T> corners{fan[0][0], fan[0][1]};
    for (const std::array<T, 3>& triangle : fan) {
        corners.push_back(triangle[2]);
    }
    for (std::size_t i = 0; i < fan.size(); ++i) {
        fan[i] = {corners[triangles[i][0]], corners[triangles[i][1]], corners[triangles[i][2]]};
    }
}

}  // namespace pt
