// The axis `traversal`: in which order a warp's lanes visit nodes and test triangles.
#pragma once

#include "variants/axis.h"

namespace pt {

struct TraversalTraits {
    bool is_accelerators_own = false;  // with traversal_stack=local the accelerator's own loop is compiled
    bool needs_own_kernel = false;
};

namespace traversal {

using Traits = TraversalTraits;
inline constexpr Axis axis_facts{
    .what = "in which order a warp's lanes visit nodes and test triangles",
    .order = 170,
    .since = "148f491",
    .as_before = "while_while",
};

}  // namespace traversal
}  // namespace pt
