// The facts that an axis states of itself in variants/AXIS/axis.h, beside its choices.
#pragma once

#include <string_view>

namespace pt {

struct Axis {
    std::string_view key = {};        // name of the axis, which is that of its folder
    std::string_view what;            // what the axis decides, in one line
    int order = 0;                    // place of the axis in a variant's name, lowest first; no two axes share a place
    std::string_view since = "";      // commit that added the axis, which older result files lack; empty: the first
    std::string_view as_before = "";  // what every variant had before the axis was added; empty: a first axis
    // Whether `ptbench verify` combines the axis's choices with those of other axes in pairs only: the product of all
    // axes would take hundreds of times as long.
    bool by_pairs = false;
    // Whether the axis's choices decide the error at a number of samples; those of other axes decide the time alone.
    bool decides_error = false;
    // Whether the axis decides how often a pixel stays black: how often a sample is black, and whether samples are
    // independent.
    bool decides_samples = false;
};

}  // namespace pt
