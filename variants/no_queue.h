// What the integrators without a queue cannot be combined with.
#pragma once

#include "variants/descriptor.h"

namespace pt {

// `where` the paths are kept instead of in an array.
inline Reason needs_no_queue(const VariantTraits& variant, std::string_view where) {
    const auto no_queue = [](std::string text, std::string_view name) -> Reason {
        return {"needs_queue", std::move(text) + ", not " + std::string(name)};
    };
    if (variant.compaction.compacts) {
        return no_queue("has no queue to compact: needs compaction=none", variant.compaction.name);
    }
    if (variant.sorting.sorts) {
        return no_queue("has no queue to sort: needs sorting=none", variant.sorting.name);
    }
    if (!variant.layout.keeps_paths_whole) {
        return no_queue(std::string(where) + ", no array of paths: needs layout=aos", variant.layout.name);
    }
    return {};
}

}  // namespace pt
