// Compressed wide trees made on the GPU from binary ones there: the nodes of encode(), in an order that differs from
// run to run (children of a level are numbered as they come), and so with the same hits and the same work.
#pragma once

#include <cstdint>
#include <memory>

#include "variants/accelerator/cwbvh.h"
#include "variants/bvh/gpu_node.h"

namespace pt::accelerator::cwbvh {

struct GpuEncoderMemory;

// Holds memory for one size; encode() allocates nothing and waits for nothing.
class GpuEncoder {
public:
    explicit GpuEncoder(std::uint32_t primitives);
    ~GpuEncoder();
    GpuEncoder(const GpuEncoder&) = delete;
    GpuEncoder& operator=(const GpuEncoder&) = delete;

    // Encodes the tree whose root's number, on the device, is `root`. Queued on the default stream.
    void encode(const GpuNode* nodes, const std::uint32_t* root);

    // Number of wide nodes, for which it waits. Throws std::length_error for a tree deeper than largest_depth.
    std::uint32_t node_count() const;
    const Node* device_nodes() const;
    const std::uint32_t* device_references() const;  // the primitive in each slot

private:
    std::unique_ptr<GpuEncoderMemory> memory_;
};

}  // namespace pt::accelerator::cwbvh
