// Converts binary trees on the host to nodes that hold both children's boxes and links: those of bvh2, and those of the
// tree over objects. A Node has low_x[2] .. high_z[2] and link[2].
#pragma once

#include <vector>

#include "variants/bvh/binary_tree.h"

namespace pt {

template <class Node>
void set_child(Node& node, std::uint32_t child, const Box& box, std::uint32_t link) {
    node.low_x[child] = box.low[0];
    node.low_y[child] = box.low[1];
    node.low_z[child] = box.low[2];
    node.high_x[child] = box.high[0];
    node.high_y[child] = box.high[1];
    node.high_z[child] = box.high[2];
    node.link[child] = link;
}

// Returns the inner nodes in the tree's order, the root first. A link is an inner node's number, or leaf_link_of(node).
template <class Node, class LeafLinkOf>
std::vector<Node> binary_nodes(const BinaryTree& tree, const LeafLinkOf& leaf_link_of) {
    std::vector<std::uint32_t> links;
    std::uint32_t inner_nodes = 0;
    for (const BinaryTree::Node& node : tree.nodes) {
        links.push_back(node.is_leaf() ? leaf_link_of(node) : inner_nodes++);
    }
    std::vector<Node> nodes;
    nodes.reserve(inner_nodes);
    for (const BinaryTree::Node& inner : tree.nodes) {
        if (!inner.is_leaf()) {
            nodes.emplace_back();
            for (const std::uint32_t child : {0u, 1u}) {
                set_child(nodes.back(), child, tree.nodes[inner.first + child].box, links[inner.first + child]);
            }
        }
    }
    // A tree of one leaf gets a root with an empty second child. Only a ray of NaNs enters that, and has to end, too.
    if (nodes.empty() && !tree.nodes.empty()) {
        nodes.emplace_back();
        set_child(nodes[0], 0, tree.nodes[0].box, links[0]);
        set_child(nodes[0], 1, Box{}, links[0]);
    }
    return nodes;
}

}  // namespace pt
