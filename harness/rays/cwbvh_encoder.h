// Encodes a binary tree in GPU memory as a compressed wide BVH (cwbvh) on the GPU. The nodes are those of encode() on
// the host. Their order differs from run to run, because the children of a level are numbered as they arrive, but hits
// and traversal work do not.
#pragma once

#include <cstdint>
#include <memory>

#include "variants/accelerator/cwbvh.h"
#include "variants/bvh/gpu_node.h"

namespace pt::accelerator::cwbvh {

struct GpuEncoderMemory;

// Holds the memory for encoding trees of one size; encode() neither allocates nor synchronises.
class GpuEncoder {
public:
    explicit GpuEncoder(std::uint32_t primitives);
    ~GpuEncoder();
    GpuEncoder(const GpuEncoder&) = delete;
    GpuEncoder& operator=(const GpuEncoder&) = delete;

    // Encodes a binary tree, asynchronously on the default stream. `root` points to its root's index in device memory.
    void encode(const GpuNode* nodes, const std::uint32_t* root);

    // Waits for encode() and returns the number of wide nodes. Throws std::length_error above largest_depth.
    std::uint32_t node_count() const;
    const Node* device_nodes() const;
    const std::uint32_t* device_references() const;  // by leaf slot: index of its triangle

private:
    std::unique_ptr<GpuEncoderMemory> memory_;
};

}  // namespace pt::accelerator::cwbvh
