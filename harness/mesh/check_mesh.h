// Checks of a mesh's validity, which every mesh must pass after it has been read or generated.
#pragma once

#include <string>

#include "harness/mesh/mesh.h"

namespace pt {

// Whether a triangle has no area: two corners are equal, or the cross product of two edges, in double precision, is
// zero. Its corners must be finite.
bool is_degenerate(const Mesh& mesh, const std::array<std::uint32_t, 3>& triangle);

// Removes degenerate triangles from a mesh and counts them in `degenerate_left_out`. Vertices, and the order of the
// other triangles, stay as they are.
void leave_out_degenerate(Mesh& mesh);

// Checks a mesh and removes its degenerate triangles. Throws InputError, beginning with `file`, for a mesh that is too
// large, an index out of range, a coordinate or normal that is not finite, or no triangle with an area. If a texture
// coordinate is not finite, all are dropped, since most scenes have no use for them.
void check_mesh(Mesh& mesh, const std::string& file);

}  // namespace pt
