// Runs a GPU builder of hploc.h as a choice of the axis `builder`: boxes on the host in, a tree on the host out.
#pragma once

#include "variants/builder/hploc.h"
#include "variants/builder/pairing.h"
#include "variants/cuda/runtime/check.h"

namespace pt::builder {

inline BinaryTree build_on_the_gpu(const PrimitiveBoxes& boxes, void (GpuTree::*build)(const Box* device_boxes)) {
    struct Free {
        void operator()(Box* memory) const { (void)cudaFree(memory); }
    };
    Box* memory = nullptr;
    PT_CUDA_CHECK(cudaMalloc(reinterpret_cast<void**>(&memory), boxes.size() * sizeof(Box)));
    const std::unique_ptr<Box, Free> device_boxes(memory);
    PT_CUDA_CHECK(cudaMemcpy(memory, boxes.data(), boxes.size() * sizeof(Box), cudaMemcpyHostToDevice));
    GpuTree tree(static_cast<std::uint32_t>(boxes.size()));
    (tree.*build)(memory);
    return within_depth(tree.download(), boxes);
}

}  // namespace pt::builder
