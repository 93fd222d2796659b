// Parameters of the kernels that several integrators have, one struct per kernel (kernel_parameters.h). Shared by host
// and NVRTC.
#pragma once

#include "kernels/scene_view.h"
#include "variants/cuda/device/totals.h"

namespace pt::cuda {

// Parameters of the kernel that fills the first-bounce cache by `samples` camera rays per pixel, one thread a pixel.
template <class Real>
struct FillCacheParameters {
    static constexpr const char* kernel = "fill_cache";
    SceneView<Real> scene;
    HitCache<Real> cache;
    std::uint32_t first_sample;
    std::uint32_t samples;
    Totals* totals;
};

// Parameters of the kernel that advances the first sample of a CUDA graph for its next launch.
struct AdvanceParameters {
    static constexpr const char* kernel = "advance";
    std::uint32_t* cursor;
    std::uint32_t samples;
};

}  // namespace pt::cuda
