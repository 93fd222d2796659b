// What a CUDA graph can hold of a variant: nothing that waits for the device.
#pragma once

#include "variants/registry.h"

namespace pt {

// A launch choice's unsupported_reason.
inline std::string why_not_captured(FeatureSet, const Variant& variant) {
    const Registry& registry = Registry::instance();
    for (const std::string_view axis : {"compaction", "sorting"}) {
        if (registry.at(axis, variant, Backend::cuda).descriptor.waits_for_device) {
            return "cannot hold " + std::string(axis) + "=" + variant[axis] + ", which waits for the device";
        }
    }
    return variant.tuning.contains("read_back") ? "cannot hold read_back=1, which waits for the device" : "";
}

}  // namespace pt
