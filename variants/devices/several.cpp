// Rendering on several GPUs of one host (harness/cuda/several_devices.h): each has the whole scene and an integer film
// of its own, and NCCL adds up the films. Sums in the order of samples or of a queue would give another film.
#include <array>

#include "variants/devices/here.h"
#include "variants/registry.h"

namespace pt::devices::several {
namespace {

Reason unsupported_reason(FeatureSet, const VariantTraits& variant) {
    if (variant.robustness.is_naive) {
        return {"sums_in_order", "needs robustness=robust: the textbook's film sums samples in their order"};
    }
    if (variant.sampler.is_by_position) {
        return {"sums_in_order", "needs numbers by pixel and sample, not sampler=" + std::string(variant.sampler.name)};
    }
    if (variant.first_bounce.keeps_hits && !variant.partition.is_by_rows) {
        return {"needs_rows", "keeps a pixel's first hits for all of its samples: needs partition=tiles, not " +
                                  std::string(variant.partition.name)};
    }
    return why_not_on(devices_here(), variant.devices.count);
}

Descriptor descriptor_of(std::string_view name, std::uint32_t count) {
    return {
        .axis = "devices",
        .name = name,
        .summary = "so many GPUs of one host, the scene and a film on each, films added up by NCCL",
        .origin = "ptbench",
        .traits = DevicesTraits{.count = count},
        .backends = on_cuda,
        .unsupported_reason = unsupported_reason,
    };
}

// Choices for 2 to 8 GPUs, as the largest hosts that are sold have.
const std::array registrations{Registration(descriptor_of("2", 2), {}), Registration(descriptor_of("3", 3), {}),
                               Registration(descriptor_of("4", 4), {}), Registration(descriptor_of("5", 5), {}),
                               Registration(descriptor_of("6", 6), {}), Registration(descriptor_of("7", 7), {}),
                               Registration(descriptor_of("8", 8), {})};

}  // namespace
}  // namespace pt::devices::several
