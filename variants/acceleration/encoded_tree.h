// A tree in the format of one accelerator, and what its traversal is handed. Formats hold no pointers: the same bytes
// serve host and device.
#pragma once

#include "kernels/math.h"

#include <cstdint>

#if !defined(__CUDACC_RTC__)
#include <vector>

#include "variants/acceleration/binary_tree.h"
#endif

namespace pt {

// What a traversal reads: nodes in the accelerator's format, aligned to 16 bytes, the root first. Empty: node_count 0.
struct TreeView {
    const void* nodes = nullptr;
    std::uint32_t node_count = 0;
};

// What a traversal counts of one ray, or not at all.
struct NoTraversalCounter {
    PT_HD void node() {}
    PT_HD void boxes(std::uint32_t) {}
    PT_HD void primitives(std::uint32_t) {}
};
struct TraversalCounter {
    std::uint64_t nodes_visited = 0;
    std::uint64_t boxes_tested = 0;
    std::uint64_t primitives_tested = 0;

    PT_HD void node() { ++nodes_visited; }
    PT_HD void boxes(std::uint32_t count) { boxes_tested += count; }
    PT_HD void primitives(std::uint32_t count) { primitives_tested += count; }
};

#if !defined(__CUDACC_RTC__)
struct alignas(16) NodePiece {
    std::uint32_t word[4];
};

struct EncodedTree {
    std::vector<NodePiece> nodes;
    std::uint32_t node_count = 0;
    std::vector<std::uint32_t> references;  // the primitive in each slot; leaves are ranges of slots

    TreeView view() const { return {nodes.data(), node_count}; }
};
#endif

}  // namespace pt
