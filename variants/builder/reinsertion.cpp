#include "variants/builder/reinsertion.h"

#include <algorithm>
#include <array>

#include "variants/bvh/box.h"

namespace pt::builder {

namespace {

constexpr std::uint32_t no_node = ~0u;

// A move of a reinsertion round: a node, its new sibling `to`, and the gain, by which the sum of surface areas lessens.
struct Move {
    float gain = 0;
    std::uint32_t node = no_node, to = no_node;

    bool operator<(const Move& other) const { return gain != other.gain ? gain > other.gain : node < other.node; }
};

class Reinsertion {
public:
    Reinsertion(Pairing& pairing, const PrimitiveBoxes& boxes)
        : pairing_(pairing),
          leaves_(static_cast<std::uint32_t>(pairing.leaf.size())),
          boxes_(leaves_ + pairing.left.size()),
          areas_(boxes_.size()),
          parents_(boxes_.size(), no_node) {
        for (std::uint32_t i = 0; i < leaves_; ++i) {
            set_box(i, boxes[pairing.leaf[i]]);
        }
        std::vector<std::uint32_t> order{pairing.root};
        for (std::size_t i = 0; i < order.size(); ++i) {
            if (is_inner(order[i])) {
                for (const std::uint32_t child : children(order[i])) {
                    parents_[child] = order[i];
                    order.push_back(child);
                }
            }
        }
        for (auto node = order.rbegin(); node != order.rend(); ++node) {
            if (is_inner(*node)) {
                fit(*node);
            }
        }
    }

    // Half the surface area of all inner nodes, summed.
    double surface() const {
        double sum = 0;
        for (std::size_t node = leaves_; node < areas_.size(); ++node) {
            sum += static_cast<double>(areas_[node]);
        }
        return sum;
    }

    void run_round() {
        std::vector<Move> moves(boxes_.size());
#pragma omp parallel for schedule(dynamic, 1024)
        for (std::size_t node = 0; node < moves.size(); ++node) {
            moves[node] = best_move(static_cast<std::uint32_t>(node));
        }
        std::erase_if(moves, [](const Move& move) { return !(move.gain > 0); });
        std::sort(moves.begin(), moves.end());
        std::vector<bool> is_taken(boxes_.size());
        std::vector<std::uint32_t> changed;
        for (const Move& move : moves) {
            apply(move, is_taken, changed);
        }
        refit(changed);
    }

private:
    bool is_inner(std::uint32_t node) const { return node >= leaves_; }
    std::array<std::uint32_t, 2> children(std::uint32_t node) const {
        return {pairing_.left[node - leaves_], pairing_.right[node - leaves_]};
    }
    std::uint32_t sibling(std::uint32_t node) const {
        const auto [left, right] = children(parents_[node]);
        return left == node ? right : left;
    }
    void set_box(std::uint32_t node, const Box& box) {
        boxes_[node] = box;
        areas_[node] = static_cast<float>(half_area(box));
    }
    void fit(std::uint32_t node) {
        const auto [left, right] = children(node);
        set_box(node, joined(boxes_[left], boxes_[right]));
    }
    void replace_child(std::uint32_t parent, std::uint32_t child, std::uint32_t by) {
        std::uint32_t& left = pairing_.left[parent - leaves_];
        (left == child ? left : pairing_.right[parent - leaves_]) = by;
        parents_[by] = parent;
    }

    // Finds the best new place for a node in the subtrees beside its way up to the root. A subtree is skipped where the
    // area that taking the node out saves can no longer give a gain above the best so far.
    Move best_move(std::uint32_t node) const {
        Move best;
        if (node == pairing_.root || parents_[node] == pairing_.root) {
            return best;
        }
        struct Open {
            float saved;
            std::uint32_t node;
        };
        thread_local std::vector<Open> open;
        const Box box = boxes_[node];
        const float least = areas_[node];
        const std::uint32_t parent = parents_[node];
        float saved = areas_[parent];
        std::uint32_t pivot = parent, beside = sibling(node);
        Box shrunk = boxes_[beside];
        while (true) {
            open.push_back({saved, beside});
            while (!open.empty()) {
                const Open next = open.back();
                open.pop_back();
                if (next.saved - least <= best.gain) {
                    continue;
                }
                const float gain = next.saved - static_cast<float>(half_area(joined(boxes_[next.node], box)));
                if (gain > best.gain && next.node != sibling(node)) {
                    best = {gain, node, next.node};
                }
                if (is_inner(next.node)) {
                    for (const std::uint32_t child : children(next.node)) {
                        open.push_back({gain + areas_[next.node], child});
                    }
                }
            }
            if (pivot != parent) {
                join(shrunk, boxes_[beside]);
                saved += areas_[pivot] - static_cast<float>(half_area(shrunk));
            }
            if (pivot == pairing_.root) {
                return best;
            }
            beside = sibling(pivot);
            pivot = parents_[pivot];
        }
    }

    // Makes a move of a reinsertion round, unless an earlier move of the round has taken a node that this move changes.
    void apply(const Move& move, std::vector<bool>& is_taken, std::vector<std::uint32_t>& changed) {
        const std::uint32_t parent = parents_[move.node], beside = sibling(move.node), above = parents_[parent],
                            target_parent = parents_[move.to];
        for (const std::uint32_t node : {move.node, parent, beside, above, move.to, target_parent}) {
            if (node == no_node || is_taken[node]) {
                return;
            }
        }
        if (move.to == parent || move.to == beside || is_below(move.to, move.node)) {
            return;
        }
        for (const std::uint32_t node : {move.node, parent, beside, above, move.to, target_parent}) {
            is_taken[node] = true;
        }
        replace_child(above, parent, beside);
        const std::uint32_t new_above = parents_[move.to];
        replace_child(new_above, move.to, parent);
        pairing_.left[parent - leaves_] = move.to;
        pairing_.right[parent - leaves_] = move.node;
        parents_[move.to] = parents_[move.node] = parent;
        changed.push_back(parent);
        changed.push_back(above);
    }
    // Whether `node` lies in the subtree of `top`: an earlier move may have brought a node's new place below the node.
    bool is_below(std::uint32_t node, std::uint32_t top) const {
        for (; node != no_node; node = parents_[node]) {
            if (node == top) {
                return true;
            }
        }
        return false;
    }

    // Refits the bounding boxes of all nodes above those that moves have changed, children first.
    void refit(const std::vector<std::uint32_t>& changed) {
        std::vector<bool> is_stale(boxes_.size());
        for (std::uint32_t node : changed) {
            for (; node != no_node && !is_stale[node]; node = parents_[node]) {
                is_stale[node] = true;
            }
        }
        std::vector<std::uint32_t> order;
        if (is_stale[pairing_.root]) {
            order.push_back(pairing_.root);
        }
        for (std::size_t i = 0; i < order.size(); ++i) {
            for (const std::uint32_t child : children(order[i])) {
                if (is_stale[child]) {
                    order.push_back(child);
                }
            }
        }
        for (auto node = order.rbegin(); node != order.rend(); ++node) {
            fit(*node);
        }
    }

    Pairing& pairing_;
    std::uint32_t leaves_;
    std::vector<Box> boxes_;
    std::vector<float> areas_;
    std::vector<std::uint32_t> parents_;
};

}  // namespace

void reinsert(Pairing& pairing, const PrimitiveBoxes& boxes, std::uint32_t rounds) {
    if (pairing.left.size() < 2) {
        return;
    }
    Reinsertion reinsertion(pairing, boxes);
    double before = reinsertion.surface();
    for (std::uint32_t round = 0; round < rounds; ++round) {
        reinsertion.run_round();
        const double after = reinsertion.surface();
        if (!(after < 0.999 * before)) {
            return;
        }
        before = after;
    }
}

}  // namespace pt::builder
