// Array of structures on the device: the host's side.
#include "variants/layout/aos.cuh"

#include "variants/cuda/layout_hooks.h"
#include "variants/registry.h"

namespace pt::layout::aos {
namespace {

const Registration registration(
    {
        .axis = "layout",
        .name = name,
        .summary = "array of structures: the fields of a path lie together",
        .origin = "cis565 (two CIS 565 path tracers)",
        .baseline = on_cuda,
        .traits = LayoutTraits{.keeps_paths_whole = true},
        .backends = on_cuda,
    },
    {.cuda = {.layout = cuda::layout_hooks<DevicePaths>()}});

}  // namespace
}  // namespace pt::layout::aos
