// The parameters of the megakernel, for both sides.
#pragma once

#include "kernels/film.h"
#include "variants/cuda/parameters.h"

namespace pt::cuda {

template <class Real>
struct MegakernelParameters {
    static constexpr const char* kernel = "megakernel";
    SceneView<Real> scene;
    FilmView film;
    std::uint32_t first_sample;
    std::uint32_t samples;
    std::uint32_t stride;  // threads a pixel
    HitCache<Real> cache;
    Totals* totals;
    std::uint64_t* ended;  // paths by their number of segments, or null
};

}  // namespace pt::cuda
