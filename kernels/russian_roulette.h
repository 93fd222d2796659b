// Russian roulette: a path goes on with a probability, and what it carries is divided by it, so that the mean stays.
// The probability is the largest channel of its throughput (pbrt-v4, without its correction for refraction), and a path
// whose throughput has a channel of at least 1 always goes on. Arvo and Kirk, "Particle Transport and Image Synthesis",
// SIGGRAPH 1990.
#pragma once

#include "kernels/path.h"

namespace pt {

// Plays Russian roulette by the throughput's largest entry, with u in [0, 1). Returns whether the path goes on.
template <class Real>
PT_HD inline bool survives_roulette(Path<Real>& path, Real u) {
    const Real probability = max(path.throughput.x, max(path.throughput.y, path.throughput.z));
    if (!(probability < Real(1))) {
        return true;
    }
    if (u >= probability) {
        return false;
    }
    path.throughput *= Real(1) / probability;
    return true;
}

}  // namespace pt
