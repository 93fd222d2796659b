// Structure of arrays on the device: the host's side.
#include "variants/layout/soa.cuh"

#include "variants/cuda/layout_hooks.h"
#include "variants/registry.h"

namespace pt::layout::soa {
namespace {

const Registration registration(
    {
        .axis = "layout",
        .name = name,
        .summary = "structure of arrays: one array a scalar of the path state",
        .origin = "pbrt-v4's soac; Laine, Karras and Aila 2013",
        .backends = on_cuda,
    },
    {.cuda = {.layout = cuda::layout_hooks<DevicePaths>()}});

}  // namespace
}  // namespace pt::layout::soa
