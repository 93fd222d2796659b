// Builds compressed wide trees (cwbvh) from binary ones on the host. Boxes are rounded outward, exactly, in double.
#include "variants/accelerator/cwbvh.h"

#include <cstring>
#include <stdexcept>
#include <type_traits>
#include <vector>

#include "variants/accelerator/cwbvh_encode.h"
#include "variants/bvh/encoding.h"
#include "variants/bvh/parents_first.h"
#include "variants/mesh_reasons.h"
#include "variants/registry.h"

namespace pt::accelerator::cwbvh {
namespace {

static_assert(std::is_trivially_default_constructible_v<NodeGroup>,
              "a ray would write its whole stack before it begins");

// Nodes of the binary tree after every leaf too large for a cwbvh node is halved.
std::vector<BinaryTree::Node> with_small_leaves(const BinaryTree& tree) {
    std::vector<BinaryTree::Node> nodes = tree.nodes;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        const BinaryTree::Node leaf = nodes[i];
        if (leaf.count <= largest_leaf) {
            continue;
        }
        const std::uint32_t left = leaf.count / 2;
        nodes[i] = {leaf.box, static_cast<std::uint32_t>(nodes.size()), 0};
        nodes.push_back({leaf.box, leaf.first, left});
        nodes.push_back({leaf.box, leaf.first + left, leaf.count - left});
    }
    return nodes;
}

class CutTree {
public:
    explicit CutTree(const BinaryTree& tree) : nodes_(with_small_leaves(tree)), cuts_(nodes_.size()) {
        const std::vector<std::uint32_t> order = parents_first(nodes_);
        for (auto node = order.rbegin(); node != order.rend(); ++node) {
            const float area = box_area(box(*node));
            cuts_[*node] = is_leaf(*node) ? Cut::of_leaf(area, nodes_[*node].count)
                                          : Cut::of_inner(area, cuts_[left(*node)], cuts_[right(*node)]);
        }
    }
    std::uint32_t left(std::uint32_t node) const { return nodes_[node].first; }
    std::uint32_t right(std::uint32_t node) const { return nodes_[node].first + 1; }
    bool is_leaf(std::uint32_t node) const { return nodes_[node].is_leaf(); }
    const Box& box(std::uint32_t node) const { return nodes_[node].box; }
    const Cut& cut(std::uint32_t node) const { return cuts_[node]; }

    void append_references(std::uint32_t node, const BinaryTree& tree, std::vector<std::uint32_t>& references) const {
        if (is_leaf(node)) {
            const auto first = tree.references.begin() + nodes_[node].first;
            references.insert(references.end(), first, first + nodes_[node].count);
        } else {
            append_references(left(node), tree, references);
            append_references(right(node), tree, references);
        }
    }

private:
    std::vector<BinaryTree::Node> nodes_;
    std::vector<Cut> cuts_;
};

class Encoder {
public:
    explicit Encoder(const BinaryTree& binary) : binary_(binary), tree_(binary) {}

    EncodedTree encode() {
        encoded_.references.reserve(binary_.references.size());
        wide_.emplace_back();
        open_.push_back({0, 0, 1});
        while (!open_.empty()) {
            const Open next = open_.back();
            open_.pop_back();
            if (next.depth > largest_depth) {
                throw std::length_error("cwbvh: the tree is deeper than 64 nodes of 8 children");
            }
            write(next);
        }
        encoded_.node_count = static_cast<std::uint32_t>(wide_.size());
        encoded_.nodes.resize(wide_.size() * (sizeof(Node) / sizeof(NodePiece)));
        std::memcpy(encoded_.nodes.data(), wide_.data(), wide_.size() * sizeof(Node));
        return std::move(encoded_);
    }

private:
    struct Open {
        std::uint32_t node, wide, depth;
    };

    void write(const Open& open) {
        Children children;
        if (open.node == 0 && tree_.cut(0).is_leaf()) {
            children.node[children.count++] = 0;
        } else {
            children = Children::of(tree_, open.node);
        }
        std::uint32_t at[width];
        children.put_at_corners(tree_, tree_.box(open.node), at);
        Node node = make_node(tree_, tree_.box(open.node), at);
        node.child_base = static_cast<std::uint32_t>(wide_.size());
        node.slot_base = static_cast<std::uint32_t>(encoded_.references.size());
        for (const std::uint32_t child : at) {
            if (child == no_node) {
                continue;
            }
            if (tree_.cut(child).is_leaf()) {
                tree_.append_references(child, binary_, encoded_.references);
            } else {
                open_.push_back({child, static_cast<std::uint32_t>(wide_.size()), open.depth + 1});
                wide_.emplace_back();
            }
        }
        wide_[open.wide] = node;
    }

    const BinaryTree& binary_;
    CutTree tree_;
    std::vector<Node> wide_;
    std::vector<Open> open_;
    EncodedTree encoded_;
};

}  // namespace

EncodedTree encode(const BinaryTree& tree) {
    require_encodable(tree);
    return tree.nodes.empty() ? EncodedTree{} : Encoder(tree).encode();
}

namespace {

const Registration registration(
    {
        .axis = "accelerator",
        .name = "cwbvh",
        .summary = "compressed tree of eight children a node, 80-byte nodes, visited by octant",
        .origin = "Ylitie, Karras and Laine 2017",
        .traits = AcceleratorTraits{.has_steps = true},
        .backends = on_every_backend,
        .unsupported_reason = needs_meshes,
    },
    {.accelerator = accelerator_hook<Traversal>(encode)});

}  // namespace

}  // namespace pt::accelerator::cwbvh
