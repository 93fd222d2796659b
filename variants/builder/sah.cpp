#include "variants/builder/sah.h"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "variants/bvh/box.h"
#include "variants/bvh/depth.h"

namespace pt::builder {

double tree_cost(const BinaryTree& tree, const SahCosts& costs) {
    if (tree.nodes.empty()) {
        return 0;
    }
    const double root_area = half_area(tree.nodes[0].box);
    double cost = 0;
    for (const BinaryTree::Node& node : tree.nodes) {
        const double share = root_area > 0 ? half_area(node.box) / root_area : 1.0;
        cost += share * (node.is_leaf() ? costs.intersection * node.count : costs.traversal);
    }
    return cost;
}

namespace {

bool meets(const Box& a, const Box& b) {
    bool all = true;
    for (int axis = 0; axis < 3; ++axis) {
        all = all && a.low[axis] <= b.high[axis] && b.low[axis] <= a.high[axis];
    }
    return all;
}

class Checker {
public:
    Checker(const BinaryTree& tree, const PrimitiveBoxes& boxes, bool whole)
        : tree_(tree), boxes_(boxes), whole_(whole), is_met_(boxes.size(), false), reached_(tree.nodes.size(), false) {}

    void run() {
        if (tree_.nodes.empty() != boxes_.empty()) {
            throw std::logic_error("a tree has nodes where there are no primitives, or none where there are");
        }
        if (!tree_.nodes.empty()) {
            walk();
        }
        require(std::find(reached_.begin(), reached_.end(), false) == reached_.end(), "a node is not reached", 0);
        require(slots_ == tree_.references.size(), "the leaves do not hold each reference once", 0);
        const auto lost = std::find(is_met_.begin(), is_met_.end(), false);
        require(lost == is_met_.end(), "a primitive is in no leaf", static_cast<std::size_t>(lost - is_met_.begin()));
        require(tree_depth(tree_) <= max_tree_depth, "the tree is too deep", 0);
    }

private:
    static void require(bool condition, const char* what, std::size_t where) {
        if (!condition) {
            throw std::logic_error(std::string(what) + " (" + std::to_string(where) + ")");
        }
    }

    void walk() {
        std::vector<std::uint32_t> open{0};
        reached_[0] = true;
        while (!open.empty()) {
            const std::uint32_t at = open.back();
            open.pop_back();
            const BinaryTree::Node& node = tree_.nodes[at];
            if (node.is_leaf()) {
                check_leaf(node, at);
                continue;
            }
            for (const std::size_t child : {std::size_t(node.first), std::size_t(node.first) + 1}) {
                require(child < tree_.nodes.size(), "a child does not exist", at);
                require(!reached_[child], "a node is reached twice", child);
                require(contains(node.box, tree_.nodes[child].box), "a child leaves its parent's box", child);
                reached_[child] = true;
                open.push_back(static_cast<std::uint32_t>(child));
            }
        }
    }

    void check_leaf(const BinaryTree::Node& node, std::size_t at) {
        require(std::size_t(node.first) + node.count <= tree_.references.size(), "a leaf's references end early", at);
        slots_ += node.count;
        for (std::uint32_t slot = node.first; slot < node.first + node.count; ++slot) {
            const std::uint32_t primitive = tree_.references[slot];
            require(primitive < boxes_.size(), "a reference is out of range", slot);
            const Box& box = boxes_[primitive];
            require(whole_ ? contains(node.box, box) : meets(node.box, box), "a primitive is outside its leaf", slot);
            is_met_[primitive] = true;
        }
    }

    const BinaryTree& tree_;
    const PrimitiveBoxes& boxes_;
    bool whole_;
    std::vector<bool> is_met_, reached_;
    std::size_t slots_ = 0;
};

}  // namespace

void check(const BinaryTree& tree, const PrimitiveBoxes& boxes, bool whole) { Checker(tree, boxes, whole).run(); }

}  // namespace pt::builder
