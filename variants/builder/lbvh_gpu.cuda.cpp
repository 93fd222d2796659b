// The builder lbvh_gpu, whose kernels are in hploc.cu. Its Morton codes have 63 bits and cubic cells, where those of
// `lbvh` on the host have 30 bits, and its leaves hold one primitive, so the two trees differ.
#include "variants/builder/gpu_build.h"
#include "variants/mesh_reasons.h"
#include "variants/registry.h"

namespace pt::builder::lbvh_gpu {
namespace {

const Registration registration(
    {
        .axis = "builder",
        .name = "lbvh_gpu",
        .summary = "the radix tree of Morton codes on the GPU, from the leaves up",
        .origin = "Karras 2012; Apetrei 2014",
        .backends = on_cuda,
        .unsupported_reason = needs_tree,
    },
    {.builder = {[](const PrimitiveBoxes& boxes, std::span<const Triangle<float>>) {
         return build_on_the_gpu(boxes, &GpuTree::build_lbvh);
     }}});

}  // namespace
}  // namespace pt::builder::lbvh_gpu
