// Parameters of the kernels that several integrators have, a struct a kernel (kernel_parameters.h). Shared by host and
// NVRTC.
#pragma once

#include "kernels/scene_view.h"
#include "variants/cuda/device/totals.h"

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

// Parameters of the kernel that moves the number of a CUDA graph's first sample on, for the next launch.
struct AdvanceParameters {
    static constexpr const char* kernel = "advance";
    std::uint32_t* cursor;
    std::uint32_t samples;
};

}  // namespace pt::cuda
