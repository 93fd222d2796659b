// The accelerator brute_force tests every triangle of a mesh in turn; the other accelerators are verified against it.
#pragma once

#include "kernels/intersect.h"

namespace pt::accelerator::brute_force {

using Traversal = BruteForce;

}  // namespace pt::accelerator::brute_force

#if defined(PT_HOST)

#include "variants/registry.h"

namespace pt::accelerator::brute_force {
namespace {

const Registration registration(
    {
        .axis = "accelerator",
        .name = "brute_force",
        .summary = "every triangle of every mesh in turn",
        .origin = "the reference",
        .baseline = on_every_backend,
        .traits = AcceleratorTraits{.has_tree = false},
        .backends = on_every_backend,
    },
    {.accelerator = accelerator_hook<Traversal>(nullptr)});

}  // namespace
}  // namespace pt::accelerator::brute_force

#endif
