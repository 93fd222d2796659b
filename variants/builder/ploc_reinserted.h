// The tree of PLOC (ploc.h), bettered by parallel reinsertion (reinsertion.h).
#pragma once

#include "variants/builder/sah.h"

namespace pt::builder::ploc_reinserted {

// Builds the tree. `leaf_size`: the most references of a leaf; subtrees become leaves by the surface area heuristic.
BinaryTree build(const PrimitiveBoxes& boxes, std::uint32_t leaf_size = 4, const SahCosts& costs = {});

}  // namespace pt::builder::ploc_reinserted
