// The axis `builder`: how the tree over a mesh is built.
#pragma once

#include "variants/axis.h"

namespace pt {

struct BuilderTraits {
    bool splits_primitives = false;  // the builder may put a primitive into several leaves
};

namespace builder {

using Traits = BuilderTraits;
inline constexpr Axis axis_facts{
    .what = "how the tree over a mesh is built",
    .order = 160,
    .since = "4dc231d",
    .as_before = "sah_binned",
    .by_pairs = true,
};

}  // namespace builder
}  // namespace pt
