// The axis `sampler`: where random numbers come from.
#pragma once

#include "variants/axis.h"

namespace pt {

struct SamplerTraits {
    bool is_in_every_kernel = false;  // every kernel contains this sampler, so it has no feature bit
    bool is_by_position = false;      // a path's random numbers follow from its position in the queue, not its pixel
};

namespace sampler {

using Traits = SamplerTraits;
inline constexpr Axis axis_facts{
    .what = "where random numbers come from",
    .order = 80,
    .since = "7b5cd03",
    .as_before = "pcg4d",
    .by_pairs = true,
    .decides_error = true,
    .decides_samples = true,
};

}  // namespace sampler
}  // namespace pt
