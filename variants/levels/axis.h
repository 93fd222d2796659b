// The axis `levels`: how a ray finds the objects that show meshes.
#pragma once

#include "variants/axis.h"

namespace pt {

struct LevelsTraits {
    bool is_flat = false;  // one tree holds the triangles of all objects, in the accelerator's format
};

namespace levels {

using Traits = LevelsTraits;
inline constexpr Axis axis_facts{
    .what = "how a ray finds the objects that show meshes",
    .order = 190,
    .since = "0f46c45",
    .as_before = "each_object",
    .by_pairs = true,
};

}  // namespace levels
}  // namespace pt
