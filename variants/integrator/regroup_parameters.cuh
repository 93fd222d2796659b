// The parameters of regroup, for both sides.
#pragma once

#include "kernels/film.h"
#include "variants/cuda/parameters.h"

namespace pt::cuda {

template <class Real>
struct RegroupParameters {
    static constexpr const char* kernel = "regroup";
    SceneView<Real> scene;
    FilmView film;
    std::uint32_t first_sample;
    std::uint32_t samples;
    HitCache<Real> cache;
    Totals* totals;
    std::uint64_t* ended;  // paths by their number of segments, or null
    std::uint32_t samples_per_piece;
    std::uint64_t* next_piece;
};

}  // namespace pt::cuda
