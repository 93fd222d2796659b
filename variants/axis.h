// The facts that an axis states of itself in variants/AXIS/axis.h, beside its choices.
#pragma once

#include <string_view>

namespace pt {

struct Axis {
    std::string_view key = {};        // name of the axis, which is that of its folder
    std::string_view what;            // one-line description of what an axis of variants decides
    int order = 0;                    // place of the axis in a variant's name, lowest first; no two axes share a place
    std::string_view since = "";      // commit that added the axis (older results lack it); empty: an original axis
    std::string_view as_before = "";  // choice that all variants had before the axis was added; empty: an original axis
    // Whether `ptbench verify` combines the axis's choices with those of other axes in pairs only: the product of all
    // axes would take hundreds of times as long.
    bool by_pairs = false;
    // Whether the axis's choices change the film's error at a number of samples; other axes' change the time.
    bool decides_error = false;
    // Whether the axis's choices decide how often a pixel is black: how often one of its samples is, and whether
    // samples are independent of each other.
    bool decides_samples = false;
};

}  // namespace pt
