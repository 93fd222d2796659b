// Which choices the integrators without a path queue cannot be combined with.
#pragma once

#include "variants/descriptor.h"

namespace pt {

// Why an integrator without a path queue cannot run with these choices; empty if it can. `where` tells, in the message,
// where the integrator keeps its paths instead of in an array.
inline Reason needs_no_queue(const VariantTraits& variant, std::string_view where) {
    // The reason's text is appended step by step: for concatenated strings g++ 12 warns of array bounds, depending on
    // what else the translation unit holds.
    const auto no_queue = [](std::string_view text, std::string_view name) -> Reason {
        std::string whole(text);
        whole.append(", not ").append(name);
        return {"needs_queue", std::move(whole)};
    };
    if (variant.compaction.compacts) {
        return no_queue("has no queue to compact: needs compaction=none", variant.compaction.name);
    }
    if (variant.sorting.sorts) {
        return no_queue("has no queue to sort: needs sorting=none", variant.sorting.name);
    }
    if (!variant.layout.keeps_paths_whole) {
        std::string text(where);
        text.append(", no array of paths: needs layout=aos");
        return no_queue(text, variant.layout.name);
    }
    return {};
}

}  // namespace pt
