// Lists the nodes of a binary tree breadth first: forwards for passes down the tree, backwards for passes up.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "variants/bvh/binary_tree.h"

namespace pt {

// The numbers of all nodes, each after its parent, nodes[0] (the root) first. `nodes` may hold children in any order.
inline std::vector<std::uint32_t> parents_first(std::span<const BinaryTree::Node> nodes) {
    std::vector<std::uint32_t> order(nodes.empty() ? 0 : 1, 0u);
    order.reserve(nodes.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
        if (const BinaryTree::Node& node = nodes[order[i]]; !node.is_leaf()) {
            order.push_back(node.first);
            order.push_back(node.first + 1);
        }
    }
    return order;
}

}  // namespace pt
