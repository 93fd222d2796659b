// Slots for the nodes of a tree that many threads build: siblings that divide their parent's references at position m
// have the slots 2m - 1 and 2m, which no others have. `pack` then puts nodes in depth-first order without gaps.
#pragma once

#include "variants/bvh/binary_tree.h"

#include <vector>

namespace pt::builder {

inline std::uint32_t child_slot(std::uint32_t middle) { return 2 * middle - 1; }

// Moves a tree's nodes from slots to BinaryTree's order. In `slots`, an inner node's `first` is its left child's slot.
inline std::vector<BinaryTree::Node> pack(const std::vector<BinaryTree::Node>& slots) {
    std::vector<BinaryTree::Node> nodes;
    std::size_t used = 0;
    for (const BinaryTree::Node& slot : slots) {
        used += slot.is_leaf() ? 2 : 0;
    }
    nodes.reserve(used);
    nodes.push_back(slots[0]);
    std::vector<std::uint32_t> open{0};
    while (!open.empty()) {
        const std::uint32_t at = open.back();
        open.pop_back();
        if (nodes[at].is_leaf()) {
            continue;
        }
        const std::uint32_t from = nodes[at].first, to = static_cast<std::uint32_t>(nodes.size());
        nodes[at].first = to;
        nodes.push_back(slots[from]);
        nodes.push_back(slots[from + 1]);
        open.push_back(to + 1);
        open.push_back(to);
    }
    return nodes;
}

}  // namespace pt::builder
