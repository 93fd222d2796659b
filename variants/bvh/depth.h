// How deep a tree may be: what a traversal stack can hold. Builders keep to this depth, encoders refuse deeper trees.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>

#include "variants/bvh/binary_tree.h"

namespace pt {

// The greatest depth of a tree, in edges from the root to the deepest leaf.
inline constexpr std::uint32_t max_tree_depth = 64;

// Edges from the root of a tree to its deepest leaf.
std::uint32_t tree_depth(const BinaryTree& tree);

// How many levels lie below a node of `count` references if splits halve them, down to leaves of one reference.
inline std::uint32_t halving_depth(std::size_t count) {
    return count <= 1 ? 0u : static_cast<std::uint32_t>(std::bit_width(count - 1));
}

// Whether a node at this depth may be split unevenly: a child with almost all references can still be halved to the
// end.
inline bool may_split_unevenly(std::uint32_t depth, std::size_t count) {
    return depth + 1 + halving_depth(count) <= max_tree_depth;
}

}  // namespace pt
