// Which variants a CUDA graph can hold: those in whose renders the host never waits for the device.
#pragma once

#include "variants/registry.h"

namespace pt {

// Why a variant's launches cannot be captured in a CUDA graph; empty: they can.
inline Reason why_not_captured(FeatureSet, const VariantTraits& variant) {
    const auto cannot_hold = [](const std::string& what) -> Reason {
        return {"waits_for_device", "cannot hold " + what + ", which waits for the device"};
    };
    if (variant.compaction.host_sync) {
        return cannot_hold("compaction=" + std::string(variant.compaction.name));
    }
    if (variant.sorting.host_sync) {
        return cannot_hold("sorting=" + std::string(variant.sorting.name));
    }
    return variant.tuning.contains("read_back") ? cannot_hold("read_back=1") : Reason{};
}

}  // namespace pt
