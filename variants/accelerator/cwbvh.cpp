// Compressed wide trees from binary ones: Ylitie, Karras, Laine 2017, sections 3.1 (the cut of least SAH cost) and 3.2
// (children by octants). Every box is rounded outward, exactly: planes are found in double.
#include "variants/accelerator/cwbvh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <span>
#include <stdexcept>
#include <vector>

namespace pt::accelerator::cwbvh {
namespace {

// A node visited costs as much as 10/3 triangles: the paper's.
constexpr float node_cost = 1.0f, reference_cost = 0.3f;
constexpr std::uint32_t no_node = ~0u;

float half_area(const Box& box) {
    const float x = box.high[0] - box.low[0], y = box.high[1] - box.low[1], z = box.high[2] - box.low[2];
    return x * y + y * z + z * x;
}

// The tree with leaves that a node can hold: larger ones are halved.
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

// Of a node as the root of i subtrees of the wide tree: the least cost, and how it comes about.
class Cuts {
   public:
    explicit Cuts(const std::vector<BinaryTree::Node>& nodes)
        : nodes_(nodes), cost_(nodes.size()), left_(nodes.size()), references_(nodes.size()) {
        const std::vector<std::uint32_t> order = parents_first();
        for (auto node = order.rbegin(); node != order.rend(); ++node) {
            nodes_[*node].is_leaf() ? cut_leaf(*node) : cut_inner(*node);
        }
    }

    bool is_leaf(std::uint32_t node) const { return nodes_[node].is_leaf() || left_[node][0] == leaf_here; }
    // The subtrees that become the children of one wide node.
    void children_of(std::uint32_t node, std::vector<std::uint32_t>& children) const { share(node, width, children); }
    void references_of(std::uint32_t node, const BinaryTree& tree, std::vector<std::uint32_t>& references) const {
        if (nodes_[node].is_leaf()) {
            const auto first = tree.references.begin() + nodes_[node].first;
            references.insert(references.end(), first, first + nodes_[node].count);
            return;
        }
        references_of(nodes_[node].first, tree, references);
        references_of(nodes_[node].first + 1, tree, references);
    }

   private:
    static constexpr std::uint8_t leaf_here = 1, node_here = 2;

    std::vector<std::uint32_t> parents_first() const {
        std::vector<std::uint32_t> order;
        order.reserve(nodes_.size());
        order.push_back(0);
        for (std::size_t i = 0; i < order.size(); ++i) {
            if (const BinaryTree::Node& node = nodes_[order[i]]; !node.is_leaf()) {
                order.push_back(node.first);
                order.push_back(node.first + 1);
            }
        }
        return order;
    }
    void cut_leaf(std::uint32_t node) {
        references_[node] = nodes_[node].count;
        cost_[node].fill(half_area(nodes_[node].box) * static_cast<float>(nodes_[node].count) * reference_cost);
        left_[node].fill(0);
        left_[node][0] = leaf_here;
    }
    void cut_inner(std::uint32_t node) {
        const std::uint32_t a = nodes_[node].first, b = a + 1;
        const std::uint32_t count = std::min<std::uint32_t>(references_[a] + references_[b], largest_leaf + 1);
        references_[node] = static_cast<std::uint8_t>(count);
        std::array<float, width + 1> shared{};
        std::array<std::uint8_t, width + 1> best{};
        for (std::uint32_t roots = 2; roots <= width; ++roots) {
            shared[roots] = std::numeric_limits<float>::infinity();
            for (std::uint32_t k = 1; k < roots; ++k) {
                const float cost = cost_[a][k - 1] + cost_[b][roots - k - 1];
                if (cost < shared[roots]) {
                    shared[roots] = cost;
                    best[roots] = static_cast<std::uint8_t>(k);
                }
            }
        }
        const float area = half_area(nodes_[node].box);
        const float as_node = shared[width] + area * node_cost;
        const float as_leaf = count <= largest_leaf ? area * static_cast<float>(count) * reference_cost
                                                    : std::numeric_limits<float>::infinity();
        left_[node][0] = as_leaf <= as_node ? leaf_here : node_here;
        left_[node][width - 1] = best[width];
        cost_[node][0] = std::min(as_leaf, as_node);
        for (std::uint32_t roots = 2; roots < width; ++roots) {
            const bool fewer = cost_[node][roots - 2] <= shared[roots];
            cost_[node][roots - 1] = fewer ? cost_[node][roots - 2] : shared[roots];
            left_[node][roots - 1] = fewer ? std::uint8_t{0} : best[roots];
        }
    }
    void add(std::uint32_t node, std::uint32_t roots, std::vector<std::uint32_t>& children) const {
        while (roots > 1 && left_[node][roots - 1] == 0) {
            --roots;
        }
        if (roots == 1) {
            children.push_back(node);
        } else {
            share(node, roots, children);
        }
    }
    void share(std::uint32_t node, std::uint32_t roots, std::vector<std::uint32_t>& children) const {
        const std::uint32_t left = left_[node][roots - 1];
        add(nodes_[node].first, left, children);
        add(nodes_[node].first + 1, roots - left, children);
    }

    const std::vector<BinaryTree::Node>& nodes_;
    std::vector<std::array<float, width - 1>> cost_;        // [i - 1]: as i roots
    std::vector<std::array<std::uint8_t, width>> left_;     // [i - 1]: of i roots so many left; 0: as i - 1. [0]: see above
    std::vector<std::uint8_t> references_;                  // at most one more than a leaf holds
};

// Which child stands where: the pair of child and corner that lies farthest out first.
std::array<std::uint32_t, width> at_corners(const Box& box, const std::vector<BinaryTree::Node>& nodes,
                                            const std::vector<std::uint32_t>& children) {
    std::array<std::array<float, width>, width> reach{};
    for (std::size_t c = 0; c < children.size(); ++c) {
        const Box& child = nodes[children[c]].box;
        for (std::uint32_t corner = 0; corner < width; ++corner) {
            for (std::uint32_t k = 0; k < 3; ++k) {
                const float from_centre = (child.low[k] + child.high[k]) - (box.low[k] + box.high[k]);
                reach[c][corner] += ((corner >> k) & 1u) != 0 ? from_centre : -from_centre;
            }
        }
    }
    std::array<std::uint32_t, width> at;
    at.fill(no_node);
    std::array<bool, width> placed{};
    for (std::size_t n = 0; n < children.size(); ++n) {
        std::size_t child = width, corner = width;
        for (std::size_t c = 0; c < children.size(); ++c) {
            for (std::size_t s = 0; s < width && !placed[c]; ++s) {
                if (at[s] == no_node && (child == width || reach[c][s] > reach[child][corner])) {
                    child = c, corner = s;
                }
            }
        }
        at[corner] = children[child];
        placed[child] = true;
    }
    return at;
}

float next_below(double x) {
    const float rounded = static_cast<float>(x);
    return static_cast<double>(rounded) <= x ? rounded : std::nextafter(rounded, -std::numeric_limits<float>::infinity());
}

// The origin, and the least power of two as the step, with which the planes of a box stand in 0 to 255 with their room.
void set_frame(Node& node, const Box& box) {
    for (int k = 0; k < 3; ++k) {
        const double low = static_cast<double>(box.low[k]), high = static_cast<double>(box.high[k]);
        int exponent = -126;
        if (high > low) {
            std::frexp((high - low) / 256.0, &exponent);
        }
        for (exponent = std::clamp(exponent, -126, 127);; ++exponent) {
            const double step = std::ldexp(1.0, exponent);
            node.origin[k] = next_below(low - plane_room * step);
            if ((high - static_cast<double>(node.origin[k])) / step + plane_room <= 255.0 || exponent == 127) {
                break;
            }
        }
        node.exponent[k] = static_cast<std::uint8_t>(exponent + 127);
    }
}

void set_box(Node& node, std::uint32_t corner, const Box& box) {
    for (int k = 0; k < 3; ++k) {
        const double step = std::ldexp(1.0, node.exponent[k] - 127), origin = static_cast<double>(node.origin[k]);
        const double low = std::floor((static_cast<double>(box.low[k]) - origin) / step - plane_room);
        const double high = std::ceil((static_cast<double>(box.high[k]) - origin) / step + plane_room);
        node.plane[k][0][corner] = static_cast<std::uint8_t>(std::clamp(low, 0.0, 255.0));
        node.plane[k][1][corner] = static_cast<std::uint8_t>(std::clamp(high, 0.0, 255.0));
    }
}

class Encoder {
   public:
    explicit Encoder(const BinaryTree& tree) : tree_(tree), nodes_(with_small_leaves(tree)), cuts_(nodes_) {}

    EncodedTree encode() {
        encoded_.references.reserve(tree_.references.size());
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
        std::vector<std::uint32_t> children;
        if (open.node == 0 && cuts_.is_leaf(0)) {
            children.push_back(0);
        } else {
            cuts_.children_of(open.node, children);
        }
        const Box& box = nodes_[open.node].box;
        const std::array<std::uint32_t, width> at = at_corners(box, nodes_, children);
        Node node{};
        set_frame(node, box);
        node.child_base = static_cast<std::uint32_t>(wide_.size());
        node.slot_base = static_cast<std::uint32_t>(encoded_.references.size());
        for (std::uint32_t corner = 0; corner < width; ++corner) {
            if (at[corner] == no_node) {
                continue;
            }
            set_box(node, corner, nodes_[at[corner]].box);
            if (cuts_.is_leaf(at[corner])) {
                const std::size_t first = encoded_.references.size();
                cuts_.references_of(at[corner], tree_, encoded_.references);
                const std::size_t count = encoded_.references.size() - first;
                node.contents |= ((1u << count) - 1u) << (3u * corner);
            } else {
                node.contents |= 1u << (24u + corner);
                open_.push_back({at[corner], static_cast<std::uint32_t>(wide_.size()), open.depth + 1});
                wide_.emplace_back();
            }
        }
        wide_[open.wide] = node;
    }

    const BinaryTree& tree_;
    std::vector<BinaryTree::Node> nodes_;
    Cuts cuts_;
    std::vector<Node> wide_;
    std::vector<Open> open_;
    EncodedTree encoded_;
};

}  // namespace

EncodedTree encode(const BinaryTree& tree) { return tree.nodes.empty() ? EncodedTree{} : Encoder(tree).encode(); }

}  // namespace pt::accelerator::cwbvh
