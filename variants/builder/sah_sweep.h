// The builder sah_sweep, top down: of all partitions in the order of centres along an axis the best by the SAH. Wald,
// Boulos, Shirley, "Ray Tracing Deformable Scenes using Dynamic Bounding Volume Hierarchies", ACM TOG 26 (1), 2007.
#pragma once

#include "variants/builder/sah.h"

namespace pt::builder::sah_sweep {

// Builds a tree by a full SAH sweep. `leaf_size`: the most references of a leaf; the heuristic may want fewer.
BinaryTree build(const PrimitiveBoxes& boxes, std::uint32_t leaf_size = 4, const SahCosts& costs = {});

}  // namespace pt::builder::sah_sweep
