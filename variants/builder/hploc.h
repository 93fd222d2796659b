// BVH builders on the GPU: from boxes in device memory they build a binary tree there. The host can copy the tree.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "variants/bvh/binary_tree.h"
#include "variants/bvh/gpu_node.h"

namespace pt::builder {

struct GpuTreeMemory;

// A GPU builder for one number of primitives: a build allocates nothing. Every call is queued on the default stream.
class GpuTree {
public:
    explicit GpuTree(std::uint32_t primitives);
    ~GpuTree();
    GpuTree(const GpuTree&) = delete;
    GpuTree& operator=(const GpuTree&) = delete;

    // Builds the LBVH of Lauterbach et al. 2009 as Apetrei 2014 does: in the order of Morton codes, from the leaves up.
    void build_lbvh(const Box* device_boxes);
    // Builds a tree by H-PLOC: on the way up the LBVH, warps merge the nearest of up to 32 neighbours until 16 clusters
    // are left. Benthin et al., "H-PLOC: Hierarchical Parallel Locally-Ordered Clustering", HPG 2024.
    void build_hploc(const Box* device_boxes);

    std::uint32_t primitives() const;
    const GpuNode* device_nodes() const;
    const std::uint32_t* device_root() const;  // number of the tree's root node, in device memory
    BinaryTree download() const;

private:
    std::unique_ptr<GpuTreeMemory> memory_;
};

}  // namespace pt::builder
