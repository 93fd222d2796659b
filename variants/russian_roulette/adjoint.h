// The tunables of the Russian roulette of adjoint and adjoint_splitting (kernels/adjoint.h), by which paths end, or
// split, by what they are expected to bring.
#pragma once

#include "variants/registry.h"

namespace pt {

inline constexpr Tunable adjoint_paths_tunable{"adjoint_paths",
                                               16384,
                                               1,
                                               1u << 24,
                                               1,
                                               "paths that learn what to expect, before each render and in its time",
                                               true};
inline constexpr Tunable adjoint_cells_tunable{
    "adjoint_cells",
    8,
    1,
    64,
    1,
    "cells along each axis of the grid that keeps it, for six directions of normals",
    true};
inline constexpr Tunable weight_window_tunable{
    "weight_window",
    5,
    1,
    1024,
    1,
    "upper bound of the window on what a path is expected to bring over the lower; 1 is in its middle",
    true};

}  // namespace pt
