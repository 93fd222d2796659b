// Finds the room (kernels/room.h) that a scene's axis boxes make, if they do.
#pragma once

#include "kernels/scene_view.h"

namespace pt {

// A room needs: walls, each an axis box at rest whose inner face is a side of the room and reaches over the whole of
// it; on each of the three axes at least one wall; and no wall in front of an open side. Whatever else is in the scene
// may be anywhere, inside too: it is tested for itself. Of several possible rooms the one with the most walls, then
// with the lowest numbers; room.walls is 0 if there is none.
template <class Real>
Room<Real> find_room(const SceneView<Real>& scene);

extern template Room<float> find_room(const SceneView<float>&);
extern template Room<double> find_room(const SceneView<double>&);

}  // namespace pt
