#include "variants/builder/pairing.h"

#include <algorithm>

#include "variants/bvh/box.h"
#include "variants/bvh/depth.h"
#include "variants/bvh/parents_first.h"

namespace pt::builder {

namespace {

class Assembly {
public:
    Assembly(const Pairing& pairing, const PrimitiveBoxes& boxes, std::uint32_t leaf_size, const SahCosts& costs)
        : pairing_(pairing),
          boxes_(boxes),
          leaves_(static_cast<std::uint32_t>(pairing.leaf.size())),
          leaf_size_(std::max(leaf_size, 1u)),
          costs_(costs),
          subtrees_(pairing.leaf.size() + pairing.left.size()) {}

    BinaryTree run() {
        measure();
        tree_.nodes.reserve(subtrees_.size());
        tree_.references.reserve(leaves_);
        tree_.nodes.emplace_back();
        std::vector<Open> open{{pairing_.root, 0, 0}};
        while (!open.empty()) {
            const Open next = open.back();
            open.pop_back();
            place(next, open);
        }
        return std::move(tree_);
    }

private:
    struct Subtree {
        Box box;
        std::uint32_t count = 1, height = 0;
        double cost = 0;  // SAH cost of a subtree: half surface area times cost of a node, summed over its nodes
        bool is_leaf = true;
    };
    struct Open {
        std::uint32_t node, slot, depth;
    };

    std::uint32_t left(std::uint32_t node) const { return pairing_.left[node - leaves_]; }
    std::uint32_t right(std::uint32_t node) const { return pairing_.right[node - leaves_]; }

    // Computes bounding boxes, counts and SAH costs of all subtrees from the primitives up.
    void measure() {
        for (std::uint32_t i = 0; i < leaves_; ++i) {
            subtrees_[i].box = boxes_[pairing_.leaf[i]];
            subtrees_[i].cost = costs_.intersection * half_area(subtrees_[i].box);
        }
        std::vector<std::uint32_t> order;
        order.reserve(pairing_.left.size());
        if (pairing_.root >= leaves_) {
            order.push_back(pairing_.root);
        }
        for (std::size_t i = 0; i < order.size(); ++i) {
            for (const std::uint32_t child : {left(order[i]), right(order[i])}) {
                if (child >= leaves_) {
                    order.push_back(child);
                }
            }
        }
        for (auto at = order.rbegin(); at != order.rend(); ++at) {
            measure(subtrees_[*at], subtrees_[left(*at)], subtrees_[right(*at)]);
        }
    }

    void measure(Subtree& tree, const Subtree& a, const Subtree& b) const {
        tree.box = joined(a.box, b.box);
        tree.count = a.count + b.count;
        const double area = half_area(tree.box), as_leaf = costs_.intersection * area * tree.count;
        tree.cost = costs_.traversal * area + a.cost + b.cost;
        tree.is_leaf = tree.count <= leaf_size_ && as_leaf <= tree.cost;
        tree.cost = tree.is_leaf ? as_leaf : tree.cost;
        tree.height = tree.is_leaf ? 0 : 1 + std::max(a.height, b.height);
    }

    void place(const Open& next, std::vector<Open>& open) {
        const Subtree& subtree = subtrees_[next.node];
        if (subtree.is_leaf) {
            const auto first = static_cast<std::uint32_t>(tree_.references.size());
            append_primitives(next.node, tree_.references);
            tree_.nodes[next.slot] = {subtree.box, first, subtree.count};
            return;
        }
        const bool fits = next.depth + subtree.height <= max_tree_depth;
        if (!fits && !may_split_unevenly(next.depth, subtree.count)) {
            std::vector<std::uint32_t> primitives;
            append_primitives(next.node, primitives);
            halve(primitives.data(), subtree.count, next.slot);
            return;
        }
        const auto child = static_cast<std::uint32_t>(tree_.nodes.size());
        tree_.nodes[next.slot] = {subtree.box, child, 0};
        tree_.nodes.resize(child + 2);
        open.push_back({right(next.node), child + 1, next.depth + 1});
        open.push_back({left(next.node), child, next.depth + 1});
    }

    void append_primitives(std::uint32_t root, std::vector<std::uint32_t>& primitives) const {
        std::vector<std::uint32_t> open{root};
        while (!open.empty()) {
            const std::uint32_t node = open.back();
            open.pop_back();
            if (node < leaves_) {
                primitives.push_back(pairing_.leaf[node]);
            } else {
                open.push_back(right(node));
                open.push_back(left(node));
            }
        }
    }

    void halve(const std::uint32_t* primitives, std::uint32_t count, std::uint32_t slot) {
        Box box;
        for (std::uint32_t i = 0; i < count; ++i) {
            join(box, boxes_[primitives[i]]);
        }
        if (count <= leaf_size_) {
            tree_.nodes[slot] = {box, static_cast<std::uint32_t>(tree_.references.size()), count};
            tree_.references.insert(tree_.references.end(), primitives, primitives + count);
            return;
        }
        const auto child = static_cast<std::uint32_t>(tree_.nodes.size());
        tree_.nodes[slot] = {box, child, 0};
        tree_.nodes.resize(child + 2);
        halve(primitives, count / 2, child);
        halve(primitives + count / 2, count - count / 2, child + 1);
    }

    const Pairing& pairing_;
    const PrimitiveBoxes& boxes_;
    std::uint32_t leaves_, leaf_size_;
    SahCosts costs_;
    std::vector<Subtree> subtrees_;
    BinaryTree tree_;
};

// Converts a finished tree back to a Pairing. The pairing's leaves are the tree's references; the references of one
// leaf are joined one after the other.
Pairing siblings_in(const BinaryTree& tree) {
    Pairing pairing;
    pairing.leaf = tree.references;
    const std::vector<std::uint32_t> order = parents_first(tree.nodes);
    std::vector<std::uint32_t> number(tree.nodes.size());
    const auto join_nodes = [&](std::uint32_t left, std::uint32_t right) {
        pairing.left.push_back(left);
        pairing.right.push_back(right);
        return static_cast<std::uint32_t>(pairing.leaf.size() + pairing.left.size() - 1);
    };
    for (auto at = order.rbegin(); at != order.rend(); ++at) {
        const BinaryTree::Node& node = tree.nodes[*at];
        if (node.is_leaf()) {
            number[*at] = node.first;
            for (std::uint32_t i = 1; i < node.count; ++i) {
                number[*at] = join_nodes(number[*at], node.first + i);
            }
        } else {
            number[*at] = join_nodes(number[node.first], number[node.first + 1]);
        }
    }
    pairing.root = number[0];
    return pairing;
}

}  // namespace

BinaryTree assemble(const Pairing& pairing, const PrimitiveBoxes& boxes, std::uint32_t leaf_size,
                    const SahCosts& costs) {
    return pairing.leaf.empty() ? BinaryTree{} : Assembly(pairing, boxes, leaf_size, costs).run();
}

BinaryTree within_depth(BinaryTree tree, const PrimitiveBoxes& boxes, std::uint32_t leaf_size) {
    return tree_depth(tree) <= max_tree_depth ? tree : assemble(siblings_in(tree), boxes, leaf_size, {});
}

}  // namespace pt::builder
