// Checks and conversions that the encoders of accelerators share on the host.
#pragma once

#include <cstring>
#include <stdexcept>
#include <string>

#include "variants/bvh/depth.h"
#include "variants/bvh/encoded_tree.h"
#include "variants/bvh/link.h"

namespace pt {

inline void require_at_most(std::size_t found, std::size_t allowed, const char* what) {
    if (found > allowed) {
        throw std::length_error("a tree with " + std::to_string(found) + " " + what + "; at most " +
                                std::to_string(allowed) + " are allowed");
    }
}

// Throws std::length_error for a tree that links cannot express or a traversal stack cannot hold.
inline void require_encodable(const BinaryTree& tree, std::uint32_t max_depth = max_tree_depth) {
    require_at_most(tree.references.size(), max_slots, "references");
    require_at_most(tree.nodes.size(), std::size_t(2) * max_slots, "nodes");
    for (const BinaryTree::Node& node : tree.nodes) {
        require_at_most(node.count, max_leaf_size, "references in a leaf");
    }
    require_at_most(tree_depth(tree), max_depth, "levels");
}

// Copies an accelerator's nodes, whose size is a multiple of 16 bytes, into an EncodedTree.
template <class Node>
EncodedTree encoded(const std::vector<Node>& nodes, const std::vector<std::uint32_t>& references) {
    static_assert(sizeof(Node) % sizeof(NodePiece) == 0 && std::is_trivially_copyable_v<Node>);
    EncodedTree tree;
    tree.nodes.resize(nodes.size() * sizeof(Node) / sizeof(NodePiece));
    if (!nodes.empty()) {
        std::memcpy(tree.nodes.data(), nodes.data(), nodes.size() * sizeof(Node));
    }
    tree.node_count = static_cast<std::uint32_t>(nodes.size());
    tree.references = references;
    return tree;
}

}  // namespace pt
