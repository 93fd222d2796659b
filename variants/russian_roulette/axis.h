// The axis `russian_roulette`: whether paths end by chance.
#pragma once

#include "variants/axis.h"

namespace pt {

struct RouletteTraits {
    bool ends_paths = true;
    bool splits_paths = false;
};

namespace russian_roulette {

using Traits = RouletteTraits;
inline constexpr Axis axis_facts{
    .what = "whether paths end by chance",
    .order = 70,
    .since = "7b5cd03",
    .as_before = "off",
    .by_pairs = true,
    .decides_error = true,
    .decides_samples = true,
};

}  // namespace russian_roulette
}  // namespace pt
