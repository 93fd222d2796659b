// Collapses a binary tree into a wide one: a wide node takes in the inner nodes below it, largest first, until it has
// `width` children. Wald, Benthin, Boulos, "Getting Rid of Packets", 2008; by area: Dammertz, Hanika, Keller 2008.
#pragma once

#include <cstdint>
#include <vector>

#include "variants/bvh/binary_tree.h"

namespace pt {

inline constexpr std::uint32_t max_width = 8;

struct WideTree {
    struct Node {
        std::uint32_t child[max_width];  // binary nodes that become children of the wide node
        std::uint32_t inner[max_width];  // wide node's number for a child that is an inner node; 0 for a leaf
        std::uint32_t count;             // number of children of the wide node
    };
    std::vector<Node> nodes;  // wide nodes depth first, root first; a tree of one leaf is a root with one child
};

// Most entries on the stack of a traversal that pushes all children of a node and pops one. Children that do not exist
// count too, as rays of NaNs enter them.
std::uint32_t stack_need(const WideTree& tree, std::uint32_t width);

// Collapses a binary tree into one of up to `width` children a node, largest area first. Where this would need a
// traversal stack of more than `stack_size` entries, the highest subtrees are taken in instead: then stack_size >= 1 +
// (width - 1) * max(1, ceil(depth / log2(width))) always suffices. Throws std::length_error otherwise.
WideTree collapse(const BinaryTree& tree, std::uint32_t width, std::uint32_t stack_size);

}  // namespace pt
