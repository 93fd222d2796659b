// How deep a tree may be: what a traversal's stack can hold. Builders keep to it, encoders refuse what is deeper.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>

#include "variants/bvh/binary_tree.h"

namespace pt {

// Nodes from the root to the deepest leaf, the root not counted.
inline constexpr std::uint32_t max_tree_depth = 64;

// Edges from the root of a tree to its deepest leaf.
std::uint32_t tree_depth(const BinaryTree& tree);

// The depth that halving by number needs below a node with `count` references.
inline std::uint32_t halving_depth(std::size_t count) {
    return count <= 1 ? 0u : static_cast<std::uint32_t>(std::bit_width(count - 1));
}

// Whether a child of a node at this depth, with almost all its references, could still be halved down to single ones.
inline bool may_split_unevenly(std::uint32_t depth, std::size_t count) {
    return depth + 1 + halving_depth(count) <= max_tree_depth;
}

}  // namespace pt
