// A tree in the node format of one accelerator, and the view of it that a traversal is handed. Formats hold no
// pointers: the same bytes serve host and device.
#pragma once

#include "kernels/mesh_view.h"

#include <cstdint>

#if !defined(__CUDACC_RTC__)
#include <vector>

#include "variants/bvh/binary_tree.h"
#endif

namespace pt {

#if !defined(__CUDACC_RTC__)
struct alignas(16) NodePiece {
    std::uint32_t word[4];
};

struct EncodedTree {
    std::vector<NodePiece> nodes;
    std::uint32_t node_count = 0;
    std::vector<std::uint32_t> references;  // primitive in each slot; a leaf is a range of slots

    TreeView view() const {
        return {nodes.data(), node_count, static_cast<std::uint32_t>(references.size()), node_bytes()};
    }
    // Size of one node of the tree in bytes; 0 if the tree has no node.
    std::uint32_t node_bytes() const {
        return node_count == 0 ? 0 : static_cast<std::uint32_t>(nodes.size() * sizeof(NodePiece) / node_count);
    }
};
#endif

}  // namespace pt
