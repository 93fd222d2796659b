// The result of a bottom-up builder: which nodes are siblings. `assemble` makes a tree of these pairs for accelerators.
#pragma once

#include <cstdint>
#include <vector>

#include "variants/builder/sah.h"

namespace pt::builder {

// The siblings that a builder found: nodes 0 to n - 1 are the primitives `leaf[i]`, node n + k is the inner node k.
struct Pairing {
    std::vector<std::uint32_t> leaf;
    std::vector<std::uint32_t> left, right;  // left and right child of each inner node
    std::uint32_t root = 0;
};

// Makes a tree of siblings. Subtrees of at most `leaf_size` primitives become leaves where that is no dearer (Meister
// and Bittner 2018, section 3.3); subtrees deeper than max_tree_depth are halved by number, in leaf order.
BinaryTree assemble(const Pairing& pairing, const PrimitiveBoxes& boxes, std::uint32_t leaf_size,
                    const SahCosts& costs);

// Returns a tree as it is if it is no deeper than max_tree_depth, else a tree assembled from its pairs of siblings.
BinaryTree within_depth(BinaryTree tree, const PrimitiveBoxes& boxes, std::uint32_t leaf_size = 4);

}  // namespace pt::builder
