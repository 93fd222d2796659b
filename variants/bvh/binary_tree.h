// A binary bounding volume hierarchy as builders leave it on the host and accelerators take it up: each accelerator
// turns it into nodes of its own width and format.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

namespace pt {

// A closed bounding box. A default one is empty and the identity of `join`.
struct Box {
    float low[3] = {std::numeric_limits<float>::infinity(), std::numeric_limits<float>::infinity(),
                    std::numeric_limits<float>::infinity()};
    float high[3] = {-std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity(),
                     -std::numeric_limits<float>::infinity()};
};

struct BinaryTree {
    struct Node {
        Box box;
        std::uint32_t first = 0;  // inner node: its left child, which its right one follows; leaf: its first reference
        std::uint32_t count = 0;  // leaf: number of its references; inner node: 0

        bool is_leaf() const { return count != 0; }
    };
    std::vector<Node> nodes;                // the root is nodes[0]; a tree without primitives has no nodes
    std::vector<std::uint32_t> references;  // primitives in the order of the leaves; spatial splits repeat some
};

// Bounding boxes of whole primitives, rounded outward, one for each primitive: what a builder builds a tree over.
using PrimitiveBoxes = std::vector<Box>;

}  // namespace pt
