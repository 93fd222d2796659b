// The builder sah_binned, top down: the best of 16 planes an axis by the SAH, from bins of centres. Wald, "On fast
// Construction of SAH-based Bounding Volume Hierarchies", RT 2007. The tree is the same on any number of cores.
#pragma once

#include "variants/builder/sah.h"

namespace pt::builder::sah_binned {

// Builds a tree by binned SAH. `leaf_size`: the most references of a leaf; the heuristic may want fewer.
BinaryTree build(const PrimitiveBoxes& boxes, std::uint32_t leaf_size = 4, const SahCosts& costs = {});

}  // namespace pt::builder::sah_binned
