// Triangulates polygons of mesh files.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "harness/mesh/mesh.h"

namespace pt {

// Triangulation of a polygon: the fan around the first corner where that covers the polygon, as for every convex one;
// otherwise by ear clipping (Meisters 1975), which allows touching edges so that holes may be bridged. Triangles keep
// the polygon's winding.
struct PolygonTriangles {
    // Corner indices of the polygon's triangles, two fewer than it has corners. Empty: use the first corner's fan.
    std::vector<std::array<std::uint32_t, 3>> triangles;
    // Warning that the triangulated surface may differ from the intended one; empty if there is no doubt.
    std::string_view doubt;
};

// Triangulates a polygon of at least three corners, all finite.
PolygonTriangles triangulate(std::span<const std::array<float, 3>> corners);

// Replaces a polygon's fan of triangles by its triangulation, in data of the corners such as vertex indices.
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
