// What an axis says of itself, in variants/AXIS/axis.h beside its choices.
#pragma once

#include <string_view>

namespace pt {

struct Axis {
    std::string_view key = {};        // the name of its folder, which need not say it
    std::string_view what;            // in a line
    int order = 0;                    // a variant's name spells axes from the lowest one on; no two have the same
    std::string_view since = "";      // the commit that brought it; empty: the first one. Older result files lack it.
    std::string_view as_before = "";  // what every variant was until then; empty: of the first axes
    // Whether `ptbench verify` has the choices meet all others two by two alone: with a product of all it would take
    // hundreds of times as long.
    bool by_pairs = false;
    // Whether the choices decide the error at a number of samples; those of the other axes decide the time alone.
    bool decides_error = false;
    // Whether the choices decide how often a pixel stays black: how often a sample is, and whether samples are
    // independent.
    bool decides_samples = false;
};

}  // namespace pt
