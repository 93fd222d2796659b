// The builder ploc_reinserted: the tree of PLOC (ploc.h), improved by parallel reinsertion (reinsertion.h).
#pragma once

#include "variants/builder/sah.h"

namespace pt::builder::ploc_reinserted {

// Builds a PLOC tree with reinsertion. `leaf_size`: the most references of a leaf; subtrees become leaves by the SAH.
BinaryTree build(const PrimitiveBoxes& boxes, std::uint32_t leaf_size = 4, const SahCosts& costs = {});

}  // namespace pt::builder::ploc_reinserted
