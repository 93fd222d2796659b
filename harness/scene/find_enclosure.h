// Finds the enclosure (kernels/axis_aligned_enclosure.h) that a scene's boxes form, as walls of a Cornell box do.
#pragma once

#include "kernels/scene_view.h"

namespace pt {

// Finds the enclosure of a scene, which needs at least one wall on each of the three axes and no wall in front of an
// open side. A wall is an axis-aligned box at rest whose inner face covers a whole side of the enclosure. Other objects
// may be anywhere, even inside: each is tested for itself. Of several possible enclosures the one with the most walls
// wins, then the one with the lowest box numbers. If there is none, `enclosure.walls` is 0.
template <class Real>
AxisAlignedEnclosure<Real> find_enclosure(const SceneView<Real>& scene);

extern template AxisAlignedEnclosure<float> find_enclosure(const SceneView<float>&);
extern template AxisAlignedEnclosure<double> find_enclosure(const SceneView<double>&);

}  // namespace pt
