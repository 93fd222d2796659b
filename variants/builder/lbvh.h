// The builder lbvh on the host: the radix tree of the primitives' Morton codes, all inner nodes in parallel. Karras,
// "Maximizing Parallelism in the Construction of BVHs, Octrees, and k-d Trees", HPG 2012.
#pragma once

#include "variants/builder/sah.h"

namespace pt::builder::lbvh {

// Builds a tree by LBVH. `leaf_size`: the most references of a leaf; subtrees become leaves by the SAH.
BinaryTree build(const PrimitiveBoxes& boxes, std::uint32_t leaf_size = 4, const SahCosts& costs = {});

}  // namespace pt::builder::lbvh
