// What the integrators without a queue cannot be combined with.
#pragma once

#include "variants/descriptor.h"

namespace pt {

// Why an integrator without a queue cannot run with these choices; `where` it keeps paths instead of in an array.
// Empty: it can.
inline Reason needs_no_queue(const VariantTraits& variant, std::string_view where) {
    // The text is appended step by step: of sums of strings g++ 12 warns of bounds, depending on what else a unit
    // holds.
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
