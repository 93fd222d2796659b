// The surface area heuristic, common to builders: what a tree costs to trace, in units of one primitive's test.
// Goldsmith and Salmon, IEEE CG&A 7 (5), 1987; MacDonald and Booth, The Visual Computer 6 (3), 1990.
#pragma once

#include <cstddef>

#include "variants/bvh/binary_tree.h"

namespace pt::builder {

// SAH costs of a visited node and of a tested triangle, as in Stich et al. 2009 and Meister, Bittner 2018.
struct SahCosts {
    double traversal = 1.2;     // cost of visiting an inner node in units of the SAH
    double intersection = 1.0;  // cost of testing a primitive in units of the SAH
};

// Whether an inner node is cheaper than a leaf by the SAH. `split_cost`: half area times count, of both children.
inline bool split_pays(const SahCosts& costs, double area, std::size_t count, double split_cost) {
    return costs.traversal * area + costs.intersection * split_cost <
           costs.intersection * static_cast<double>(count) * area;
}

// Expected cost of a line through the root's bounding box: sum of area / root's area x cost over nodes. 0 for an empty
// tree; where the root has no area, each node counts in full.
double tree_cost(const BinaryTree& tree, const SahCosts& costs = {});

// Throws std::logic_error that says what is wrong with a tree over `boxes`: a primitive no leaf refers to, a reference
// out of range, a node reached twice or never, a child that leaves its parent's box, a leaf that does not meet its
// primitive's box (or, `whole`, does not contain it), a depth beyond max_tree_depth.
void check(const BinaryTree& tree, const PrimitiveBoxes& boxes, bool whole = true);

}  // namespace pt::builder
