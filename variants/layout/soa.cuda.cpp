// Structure of arrays on the device: the host's side.
#include "variants/layout/soa.cuh"

#include "variants/cuda/layout_hooks.h"
#include "variants/registry.h"

namespace pt {
namespace {

const Registration registration(
    {
        .axis = "layout",
        .name = layout::soa::name,
        .summary = "structure of arrays: one array a scalar of the path state",
        .origin = "pbrt-v4's soac; Laine, Karras and Aila 2013",
        .backends = on_cuda,
    },
    {.cuda = {.layout = cuda::layout_hooks<layout::soa::DevicePaths>()}});

}  // namespace
}  // namespace pt
