// What sorts have in common that move the paths themselves, not slot numbers.
#pragma once

#include "variants/descriptor.h"

namespace pt {

// Why a choice that needs all paths in play to lie in slots 0 to count - 1 cannot run; empty: it can.
inline Reason needs_contiguous_payload(const VariantTraits& variant) {
    if (variant.compaction.payload_contiguous) {
        return {};
    }
    return {"needs_contiguous_payload",
            "moves a contiguous payload, which compaction=" + std::string(variant.compaction.name) + " does not keep"};
}

}  // namespace pt
