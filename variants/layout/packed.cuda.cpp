// Columns of 16 bytes on the device: the host's side.
#include "variants/layout/packed.cuh"

#include "variants/cuda/layout_hooks.h"
#include "variants/registry.h"

namespace pt::layout::packed {
namespace {

const Registration registration(
    {
        .axis = "layout",
        .name = name,
        .summary =
            "columns of 16 bytes: origin and time, direction and surface, throughput and segment, radiance and medium",
        .origin = "Laine, Karras and Aila 2013 (16-byte accesses)",
        .backends = on_cuda,
        .unsupported_reason = [](FeatureSet, const VariantTraits& variant) -> Reason {
            if (variant.precision.is_single()) {
                return {};
            }
            return {"needs_single_precision", "packs single-precision fields: needs precision=float"};
        },
    },
    {.cuda = {.layout = cuda::layout_hooks<DevicePaths>()}});

}  // namespace
}  // namespace pt::layout::packed
