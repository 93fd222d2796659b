#include "variants/accelerator/bvh2.h"

#include "variants/acceleration/encoding.h"
#include "variants/acceleration/reasons.h"
#include "variants/registry.h"

namespace pt::accelerator::bvh2 {

namespace {

// The number of each inner node among inner nodes, in their order; the root's is 0.
std::vector<std::uint32_t> inner_numbers(const BinaryTree& tree) {
    std::vector<std::uint32_t> numbers(tree.nodes.size(), 0);
    std::uint32_t count = 0;
    for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
        numbers[i] = count;
        count += tree.nodes[i].is_leaf() ? 0 : 1;
    }
    return numbers;
}

void set_child(Node& node, int child, const Box& box, std::uint32_t link) {
    node.low_x[child] = box.low[0];
    node.low_y[child] = box.low[1];
    node.low_z[child] = box.low[2];
    node.high_x[child] = box.high[0];
    node.high_y[child] = box.high[1];
    node.high_z[child] = box.high[2];
    node.link[child] = link;
}

}  // namespace

EncodedTree encode(const BinaryTree& tree) {
    require_encodable(tree, stack_size);
    if (tree.nodes.empty()) {
        return {};
    }
    const std::vector<std::uint32_t> numbers = inner_numbers(tree);
    const auto link_of = [&](std::uint32_t at) {
        const BinaryTree::Node& node = tree.nodes[at];
        return node.is_leaf() ? leaf_link(node.first, node.count) : numbers[at];
    };
    std::vector<Node> nodes;
    // A leaf alone: the second child's empty box is entered by none but a ray of NaNs, which must come to an end too.
    if (tree.nodes[0].is_leaf()) {
        nodes.resize(1);
        set_child(nodes[0], 0, tree.nodes[0].box, link_of(0));
        set_child(nodes[0], 1, Box{}, link_of(0));
    }
    for (const BinaryTree::Node& inner : tree.nodes) {
        if (!inner.is_leaf()) {
            nodes.emplace_back();
            for (const int child : {0, 1}) {
                const std::uint32_t at = inner.first + static_cast<std::uint32_t>(child);
                set_child(nodes.back(), child, tree.nodes[at].box, link_of(at));
            }
        }
    }
    return encoded(nodes, tree.references);
}

namespace {

const Registration registration(
    {
        .axis = "accelerator",
        .name = "bvh2",
        .summary = "binary tree, 64-byte nodes with both children's boxes",
        .origin = "Aila and Laine 2009",
        .traits = AcceleratorTraits{.checks_large_scenes = true, .has_steps = true, .is_binary = true},
        .backends = on_every_backend,
        .unsupported_reason = needs_meshes,
    },
    {.accelerator = accelerator_hook<Traversal>(encode)});

}  // namespace

}  // namespace pt::accelerator::bvh2
