// The axis `integrator`: how paths are traced: as a queue, or one at a time.
#pragma once

#include "variants/axis.h"

namespace pt {

struct IntegratorTraits {
    bool has_queue = false;             // paths lie in memory between stages, where they can be compacted and sorted
    bool can_loop = false;              // the loop over bounces can be the loop of a CUDA graph
    bool appends_in_kernel = false;     // integrator's kernel can append paths, as compactions with AppendInKernel do
    bool seeds_by_position = false;     // samplers may be seeded by where in the queue a path lies
    bool sums_in_order = false;         // a pixel's samples are added to the film in their order
    bool traces_in_own_kernel = false;  // rays are traced in a kernel of their own, whose warps may fetch rays
    bool keeps_branches = false;        // a path may split, and the branches that wait are kept beside it
    bool appends_itself = false;        // integrator's kernel appends live paths to another queue, without a compaction
    bool refills_queue = false;         // the queue holds paths of any number of segments together
    bool inspects = false;              // every path's state is inspected between stages: for health, not for times
};

// What an integrator on the CPU is compiled for beside the feature sets of every integrator. The build reads these
// members from NAME.h (cmake/variants.cmake): each that is true is on a line of its own.
struct KernelSets {
    bool in_double = false;        // generic kernels also in double precision, and with the textbook's formulas
    bool with_path_trees = false;  // also kernels for paths that split
    bool generic_alone = false;    // no kernels for the feature sets of scenes: the integrator is not timed
};

namespace integrator {

using Traits = IntegratorTraits;
inline constexpr Axis axis_facts{
    .what = "how paths are traced: as a queue, or one at a time",
    .order = 10,
};

}  // namespace integrator
}  // namespace pt
