// Finds the enclosure (kernels/axis_aligned_enclosure.h) that a scene's axis boxes make, if they do.
#pragma once

#include "kernels/scene_view.h"

namespace pt {

// An enclosure needs: walls, each an axis box at rest whose inner face is a side of the enclosure and reaches over the
// whole of it; on each of the three axes at least one wall; and no wall in front of an open side. Whatever else is in
// the scene may be anywhere, inside too: it is tested for itself. Of several possible enclosures the one with the most
// walls, then with the lowest numbers; enclosure.walls is 0 if there is none.
template <class Real>
AxisAlignedEnclosure<Real> find_enclosure(const SceneView<Real>& scene);

extern template AxisAlignedEnclosure<float> find_enclosure(const SceneView<float>&);
extern template AxisAlignedEnclosure<double> find_enclosure(const SceneView<double>&);

}  // namespace pt
