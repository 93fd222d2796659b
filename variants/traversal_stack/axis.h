// The axis `traversal_stack`: where nodes wait that a ray has yet to visit.
#pragma once

#include "variants/axis.h"

namespace pt {

struct TraversalStackTraits {
    bool is_in_thread = false;  // all entries of the stack lie in the thread's local memory
};

namespace traversal_stack {

using Traits = TraversalStackTraits;
inline constexpr Axis axis_facts{
    .what = "where nodes wait that a ray has yet to visit",
    .order = 180,
    .since = "148f491",
    .as_before = "local",
};

}  // namespace traversal_stack
}  // namespace pt
