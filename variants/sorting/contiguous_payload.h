// What the sorts that move the paths themselves have in common.
#pragma once

#include "variants/descriptor.h"

namespace pt {

// For unsupported_reason: the paths in play must lie in slots 0 to count - 1.
inline Reason needs_contiguous_payload(const VariantTraits& variant) {
    if (variant.compaction.payload_contiguous) {
        return {};
    }
    return {"needs_contiguous_payload",
            "moves a contiguous payload, which compaction=" + std::string(variant.compaction.name) + " does not keep"};
}

}  // namespace pt
