#include "variants/bvh/depth.h"

#include <algorithm>

namespace pt {

std::uint32_t tree_depth(const BinaryTree& tree) {
    std::uint32_t deepest = 0;
    std::vector<std::uint32_t> depth(tree.nodes.size(), 0);
    std::vector<std::uint32_t> open(tree.nodes.empty() ? 0 : 1, 0u);
    while (!open.empty()) {
        const std::uint32_t at = open.back();
        open.pop_back();
        deepest = std::max(deepest, depth[at]);
        if (const BinaryTree::Node& node = tree.nodes[at]; !node.is_leaf()) {
            for (const std::uint32_t child : {node.first, node.first + 1}) {
                depth[child] = depth[at] + 1;
                open.push_back(child);
            }
        }
    }
    return deepest;
}

}  // namespace pt
