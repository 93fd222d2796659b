// The axis `integrator`: how paths are traced: as a queue, or one at a time.
#pragma once

#include "variants/axis.h"

namespace pt {

struct IntegratorTraits {
    bool has_queue = false;             // paths lie in memory between stages: to be compacted, sorted and laid out
    bool can_loop = false;              // on CUDA: its bounces can be the loop of a graph
    bool appends_in_kernel = false;     // does in its own kernel what a compaction with AppendInKernel does
    bool seeds_by_position = false;     // tells a sampler where in the queue a path lies
    bool sums_in_order = false;         // adds a pixel's samples in their order
    bool traces_in_own_kernel = false;  // which can be one whose warps fetch rays
    bool keeps_branches = false;        // a path may split: its branches wait beside it
    bool refills_queue = false;         // paths of any number of segments are in the queue together
    bool inspects = false;              // looks at every path's state between stages: for health, not for times
};

// What an integrator of the CPU is compiled for beside the feature sets of every one. The build reads these lines of
// NAME.h (cmake/variants.cmake): each member that is true is on a line of its own.
struct KernelSets {
    bool in_double = false;        // its generic kernels in double precision too, and with the textbook's formulas
    bool with_path_trees = false;  // for paths that split
    bool generic_alone = false;    // not for the feature sets of scenes: it is not timed
};

namespace integrator {

using Traits = IntegratorTraits;
inline constexpr Axis axis_facts{
    .what = "how paths are traced: as a queue, or one at a time",
    .order = 10,
};

}  // namespace integrator
}  // namespace pt
