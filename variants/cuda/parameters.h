// Parameters of the kernels that several integrators have. A kernel has one parameter, a struct that both sides include
// and that says by its member `kernel` whose it is: the host launches by the type, and PT_KERNEL (device.cuh) compiles
// only where name and size are the host's.
#pragma once

#include "kernels/scene_view.h"
#include "variants/cuda/totals.h"

namespace pt::cuda {

// Traces the camera rays that `samples` samples, no more than the cache keeps, will use: one thread a pixel.
template <class Real>
struct FillCacheParameters {
    static constexpr const char* kernel = "fill_cache";
    SceneView<Real> scene;
    HitCache<Real> cache;
    std::uint32_t first_sample;
    std::uint32_t samples;
    Totals* totals;
};

// Moves a graph's first sample on.
struct AdvanceParameters {
    static constexpr const char* kernel = "advance";
    std::uint32_t* cursor;
    std::uint32_t samples;
};

}  // namespace pt::cuda
