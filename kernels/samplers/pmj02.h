// Progressive multi-jittered (0, 2) samples: of every 2^k points one lies in each elementary rectangle of area 2^-k, at
// random within it. Christensen, Kensler and Kilpatrick, "Progressive Multi-Jittered Sample Sequences", CGF 37(4),
// 2018, search for such points; the first two coordinates of Sobol' under Owen's scrambling are such a sequence for
// every seed, without a table. A block is two such pairs, shuffled independently; the first pair is that of
// kernels/samplers/sobol_owen.h.
#pragma once

#include "kernels/samplers/sobol_owen.h"

namespace pt {

struct RandomPair {
    std::uint32_t x, y;
};

// The first two coordinates of the Sobol' point `index`, in units of 2^-32.
PT_HD inline RandomPair sobol_pair(std::uint32_t index) {
    RandomPair point{reverse_bits(index), 0};
    for (std::uint32_t y = 0x80000000u; index != 0; index >>= 1, y ^= y >> 1) {
        point.y ^= (index & 1u) != 0 ? y : 0u;
    }
    return point;
}

PT_HD inline RandomWords pmj02_words(const RandomWords& seed, const RandomKey& key) {
    const RandomWords of_dimension = words_of_dimension(seed, key);
    const RandomWords of_order = pcg4d(of_dimension);
    const RandomPair first = sobol_pair(owen_scramble(key.sample, of_order.x));
    const RandomPair second = sobol_pair(owen_scramble(key.sample, of_order.y));
    return {owen_scramble(first.x, of_dimension.x), owen_scramble(first.y, of_dimension.y),
            owen_scramble(second.x, of_dimension.z), owen_scramble(second.y, of_dimension.w)};
}

}  // namespace pt
