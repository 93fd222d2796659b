#include "variants/builder/gpu_build.h"
#include "variants/mesh_reasons.h"
#include "variants/registry.h"

namespace pt::builder::hploc {
namespace {

const Registration registration(
    {
        .axis = "builder",
        .name = "hploc",
        .summary = "bottom up on the GPU: warps merge the nearest of up to 32 neighbours in Morton order",
        .origin = "Benthin et al. 2024",
        .backends = on_cuda,
        .unsupported_reason = needs_tree,
    },
    {.builder = {[](const PrimitiveBoxes& boxes, std::span<const Triangle<float>>) {
         return build_on_the_gpu(boxes, &GpuTree::build_hploc);
     }}});

}  // namespace
}  // namespace pt::builder::hploc
