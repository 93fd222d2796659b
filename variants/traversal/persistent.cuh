// The traversal `persistent`: as many warps as fit at once, whose lanes fetch the next path's ray as they fall idle
// (Aila and Laine, HPG 2009), with the votes of Ylitie, Karras and Laine, HPG 2017. The kernel is the integrator's;
// shadow rays and the first-bounce cache, which are traced in other kernels, take the accelerator's own loop.
#pragma once

#if !defined(PT_HOST) && !defined(PT_PARAMETERS)  // device part of this file: traversal loop, which NVRTC compiles

#include "variants/traversal/warp_queue.cuh"

namespace pt::traversal::persistent {

template <class Accelerator, template <class Open, std::uint32_t most> class StackT>
struct Traversal : Accelerator {
    static constexpr bool fetches_paths = true;
    template <class Real>
    using Stack = StackT<typename Accelerator::template Walk<Real>::Open, Accelerator::template Walk<Real>::most_open>;
    using Policy = WarpPolicy<tuned::fetch_at, tuned::node_vote>;
};

}  // namespace pt::traversal::persistent

#endif

#if defined(PT_HOST)  // host part of this file: the traversal's descriptor

#include "variants/mesh_reasons.h"
#include "variants/registry.h"

namespace pt::traversal::persistent {
namespace {

constexpr Tunable tunables[] = {
    {"fetch_at", 8, 1, 32, 1, "idle lanes of a warp at which it fetches rays; 32: when all are"},
    {"node_vote", 2, 0, 32, 1,
     "a warp visits nodes where so many times the lanes that want one are at least 4 times those that want to test a "
     "triangle; 0: one node, then all its triangles"},
};

Reason unsupported_reason(FeatureSet scene, const VariantTraits& variant) {
    if (Reason reason = needs_steps(scene, variant); !reason.empty()) {
        return reason;
    }
    if (!variant.integrator.traces_in_own_kernel) {
        return {"needs_own_kernel",
                "needs an integrator with a kernel that takes rays through meshes, not integrator=" +
                    std::string(variant.integrator.name)};
    }
    return {};
}

const Registration registration(
    {
        .axis = "traversal",
        .name = "persistent",
        .summary = "as many warps as fit at once, whose idle lanes fetch paths from the queue",
        .origin = "Aila and Laine 2009; Ylitie, Karras and Laine 2017",
        .traits = TraversalTraits{.needs_own_kernel = true},
        .backends = on_cuda,
        .tunables = tunables,
        .unsupported_reason = unsupported_reason,
    },
    {});

}  // namespace
}  // namespace pt::traversal::persistent

#endif
