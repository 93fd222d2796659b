// The axis `accelerator`: how a ray finds the triangles of a mesh.
#pragma once

#include "variants/axis.h"

namespace pt {

struct AcceleratorTraits {
    bool has_tree = true;              // a choice of the axis `builder` builds the accelerator's tree
    bool builds_itself = false;        // the accelerator builds a tree of its own, without the axis `builder`
    bool checks_large_scenes = false;  // reference accelerator for scenes in which brute_force would take too long
    bool has_steps = false;            // a choice of the axis `traversal` may order the steps of the traversal (walk.h)
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
