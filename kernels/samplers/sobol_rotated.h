// Sobol' points that each pixel shifts, each coordinate by an offset of its own, modulo 1: Cranley and Patterson,
// "Randomization of Number Theoretic Methods for Multiple Integration", SIAM J. Numer. Anal. 13(6), 1976.
// Except for the scrambling this is kernels/samplers/sobol_owen.h: blocks of four dimensions, in shuffled orders.
#pragma once

#include "kernels/samplers/sobol_owen.h"

namespace pt {

PT_HD inline RandomWords sobol_rotated_words(const RandomWords& seed, const RandomKey& key) {
    const RandomWords offset = words_of_dimension(seed, key);
    const RandomWords point = sobol_point(owen_scramble(key.sample, pcg4d(offset).x));
    return {point.x + offset.x, point.y + offset.y, point.z + offset.z, point.w + offset.w};
}

}  // namespace pt
