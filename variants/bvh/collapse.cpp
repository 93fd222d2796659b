#include "variants/bvh/collapse.h"

#include <algorithm>

#include "variants/bvh/box.h"
#include "variants/bvh/encoding.h"
#include "variants/bvh/parents_first.h"

namespace pt {

namespace {

// The height of the subtree under every node of a binary tree.
std::vector<double> heights_of(const BinaryTree& tree) {
    const std::vector<std::uint32_t> order = parents_first(tree.nodes);
    std::vector<double> heights(tree.nodes.size(), 0);
    for (auto at = order.rbegin(); at != order.rend(); ++at) {
        if (const BinaryTree::Node& node = tree.nodes[*at]; !node.is_leaf()) {
            heights[*at] = 1 + std::max(heights[node.first], heights[node.first + 1]);
        }
    }
    return heights;
}

std::vector<double> areas_of(const BinaryTree& tree) {
    std::vector<double> areas;
    for (const BinaryTree::Node& node : tree.nodes) {
        areas.push_back(half_area(node.box));
    }
    return areas;
}

WideTree::Node open_up(const BinaryTree& tree, std::uint32_t root, std::uint32_t width,
                       const std::vector<double>& priority) {
    WideTree::Node wide{{root}, {}, 1};
    while (wide.count < width) {
        std::uint32_t chosen = wide.count;
        for (std::uint32_t i = 0; i < wide.count; ++i) {
            const bool is_inner = !tree.nodes[wide.child[i]].is_leaf();
            if (is_inner && (chosen == wide.count || priority[wide.child[i]] > priority[wide.child[chosen]])) {
                chosen = i;
            }
        }
        if (chosen == wide.count) {
            break;
        }
        const std::uint32_t first = tree.nodes[wide.child[chosen]].first;
        wide.child[chosen] = first;
        wide.child[wide.count++] = first + 1;
    }
    return wide;
}

WideTree collapse_by(const BinaryTree& tree, std::uint32_t width, const std::vector<double>& priority) {
    struct Open {
        std::uint32_t binary, parent, child;
    };
    WideTree wide;
    std::vector<Open> open{{0, 0, 0}};
    while (!open.empty()) {
        const Open next = open.back();
        open.pop_back();
        const auto number = static_cast<std::uint32_t>(wide.nodes.size());
        wide.nodes.push_back(open_up(tree, next.binary, width, priority));
        if (number > 0) {
            wide.nodes[next.parent].inner[next.child] = number;
        }
        for (std::uint32_t i = wide.nodes[number].count; i-- > 0;) {
            if (!tree.nodes[wide.nodes[number].child[i]].is_leaf()) {
                open.push_back({wide.nodes[number].child[i], number, i});
            }
        }
    }
    return wide;
}

}  // namespace

std::uint32_t stack_need(const WideTree& tree, std::uint32_t width) {
    std::vector<std::uint32_t> need(tree.nodes.size());
    for (std::size_t i = tree.nodes.size(); i-- > 0;) {  // children first: they have larger numbers than parents
        const WideTree::Node& node = tree.nodes[i];
        need[i] = width;
        for (std::uint32_t child = 0; child < node.count; ++child) {
            if (node.inner[child] != 0) {
                need[i] = std::max(need[i], width - 1 + need[node.inner[child]]);
            }
        }
    }
    return need.empty() ? 0 : need[0];
}

WideTree collapse(const BinaryTree& tree, std::uint32_t width, std::uint32_t stack_size) {
    require_encodable(tree);
    if (tree.nodes.empty()) {
        return {};
    }
    WideTree wide = collapse_by(tree, width, areas_of(tree));
    if (stack_need(wide, width) > stack_size) {
        wide = collapse_by(tree, width, heights_of(tree));
        require_at_most(stack_need(wide, width), stack_size, "entries on its traversal's stack");
    }
    return wide;
}

}  // namespace pt
