// Persistent warps: as many as fit at once, whose lanes fetch the next path's ray as they fall idle: Aila and Laine,
// HPG 2009, with the votes of Ylitie, Karras and Laine, HPG 2017. The kernel is its integrator's (`Fetching` is what it
// is made of); rays to lights and the first-bounce cache, which are traced in other kernels, take the accelerator's own
// loop.
#pragma once

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
