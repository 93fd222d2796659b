// Computes vertex normals from the adjacent triangles, each weighted as the cross product of the two sides at the
// vertex over the squares of their lengths (Max, "Weights for computing vertex normals from facet normals", JGT 4(2),
// 1999). Exact for vertices on a sphere, and the same on every machine, since no angles are computed.
#pragma once

#include "harness/mesh/mesh.h"

namespace pt {

// Gives each vertex a unit normal in single precision. Vertices of equal position share a normal, which is 0 if no
// adjacent triangle has one.
void give_vertex_normals(Mesh& mesh);

}  // namespace pt
