// Normals of vertices that have none, from the triangles round them: each by the cross product of its two sides there
// over the squares of their lengths (Max, "Weights for computing vertex normals from facet normals", JGT 4(2), 1999),
// which is exact where the vertices lie on a sphere, and the same on every machine: no angles are in it.
#pragma once

#include "harness/mesh/mesh.h"

namespace pt {

// Gives each vertex a normal, unit in single precision; vertices at one place have one normal, which is 0 where no
// triangle says any.
void give_vertex_normals(Mesh& mesh);

}  // namespace pt
