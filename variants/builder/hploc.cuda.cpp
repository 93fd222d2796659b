// What builders on the GPU say of themselves; kernels in hploc.cu.
#include "variants/builder/hploc.h"

#include "variants/acceleration/reasons.h"
#include "variants/builder/pairing.h"
#include "variants/cuda/check.h"
#include "variants/registry.h"

namespace pt::builder::hploc {
namespace {

BinaryTree build_on_the_gpu(const PrimitiveBoxes& boxes, std::span<const Triangle<float>>) {
    struct Free {
        void operator()(Box* memory) const { (void)cudaFree(memory); }
    };
    Box* memory = nullptr;
    PT_CUDA_CHECK(cudaMalloc(reinterpret_cast<void**>(&memory), boxes.size() * sizeof(Box)));
    const std::unique_ptr<Box, Free> device_boxes(memory);
    PT_CUDA_CHECK(cudaMemcpy(memory, boxes.data(), boxes.size() * sizeof(Box), cudaMemcpyHostToDevice));
    GpuTree tree(static_cast<std::uint32_t>(boxes.size()));
    tree.build_hploc(memory);
    return within_depth(tree.download(), boxes);
}

const Registration registration(
    {
        .axis = "builder",
        .name = "hploc",
        .summary = "bottom up on the GPU: warps merge the nearest of up to 32 neighbours in Morton order",
        .origin = "Benthin et al. 2024",
        .backends = on_cuda,
        .unsupported_reason = needs_tree,
    },
    {.builder = {build_on_the_gpu}});

}  // namespace
}  // namespace pt::builder::hploc
