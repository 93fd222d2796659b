// What every mesh must hold before anything else sees it, wherever it came from.
#pragma once

#include <string>

#include "harness/mesh/mesh.h"

namespace pt {

// Whether the triangle has no area: a corner stands twice, or the cross product of two edges, in double precision, is
// zero. Of a triangle whose corners are finite.
bool is_degenerate(const Mesh& mesh, const std::array<std::uint32_t, 3>& triangle);

// Takes degenerate triangles out and counts them in degenerate_left_out. The others keep their order, and the vertices
// stay as they are.
void leave_out_degenerate(Mesh& mesh);

// Throws InputError, with `file` before it, for a mesh that is too large, an index out of range, a coordinate or a
// normal that is not finite, or no triangle that has an area; leaves degenerate triangles out, and all texture
// coordinates where one is not finite: most scenes have no use for them.
void check_mesh(Mesh& mesh, const std::string& file);

}  // namespace pt
