// The builder ploc on the host, bottom up: clusters in Morton order merge where each is the other's nearest among its
// neighbours. Meister and Bittner, "Parallel Locally-Ordered Clustering for Bounding Volume Hierarchy Construction",
// IEEE TVCG 24 (3), 2018.
#pragma once

#include "variants/builder/pairing.h"

namespace pt::builder::ploc {

// Finds the siblings of a tree by PLOC. `radius`: how many neighbours on either side of a cluster are searched.
Pairing pair(const PrimitiveBoxes& boxes, std::uint32_t radius = 16);
// Builds a tree by PLOC. `leaf_size`: the most references of a leaf; subtrees become leaves by the SAH.
BinaryTree build(const PrimitiveBoxes& boxes, std::uint32_t leaf_size = 4, const SahCosts& costs = {},
                 std::uint32_t radius = 16);

}  // namespace pt::builder::ploc
