// The axis `accelerator`: how a ray finds the triangles of a mesh.
#pragma once

#include "variants/axis.h"

namespace pt {

struct AcceleratorTraits {
    bool has_tree = true;              // made by a choice of the axis builder
    bool builds_itself = false;        // it has none of those, but one of its own
    bool checks_large_scenes = false;  // the reference where every triangle in turn would take too long
    bool has_steps = false;            // others may put its steps in order: variants/bvh/walk.h
};

namespace accelerator {

using Traits = AcceleratorTraits;
inline constexpr Axis axis_facts{
    .what = "how a ray finds the triangles of a mesh",
    .order = 150,
    .since = "4dc231d",
    .as_before = "brute_force",
};

}  // namespace accelerator
}  // namespace pt
