// The parameters of audited, for both sides.
#pragma once

#include "kernels/film.h"
#include "kernels/health.h"
#include "variants/cuda/parameters.h"

namespace pt::cuda {

template <class Real>
struct AuditedParameters {
    static constexpr const char* kernel = "audited";
    SceneView<Real> scene;
    FilmView film;
    std::uint32_t first_sample;
    std::uint32_t samples;
    std::uint32_t stride;  // threads a pixel
    HealthRequest health;
    Totals* totals;
};

}  // namespace pt::cuda
