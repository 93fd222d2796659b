// Sobol' points with Owen's nested uniform scrambling: the samples of a pixel fill every block of four dimensions
// evenly, and blocks are made independent by shuffling the samples' order ("padding").
// Burley, "Practical Hash-based Owen Scrambling", JCGT 9(4), 2020; the hash is Vegdahl's ("Building a Better LK Hash",
// 2021), as in pbrt-v4. Direction numbers: Joe and Kuo, "Constructing Sobol Sequences with Better Two-Dimensional
// Projections", SIAM J. Sci. Comput. 30(5), 2008, dimensions 1 to 4.
#pragma once

#include "kernels/random_words.h"

namespace pt {

PT_HD inline std::uint32_t reverse_bits(std::uint32_t x) {
#if defined(__CUDA_ARCH__)
    return __brev(x);
#else
    x = (x >> 16) | (x << 16);
    x = ((x & 0xff00ff00u) >> 8) | ((x & 0x00ff00ffu) << 8);
    x = ((x & 0xf0f0f0f0u) >> 4) | ((x & 0x0f0f0f0fu) << 4);
    x = ((x & 0xccccccccu) >> 2) | ((x & 0x33333333u) << 2);
    return ((x & 0xaaaaaaaau) >> 1) | ((x & 0x55555555u) << 1);
#endif
}

// A permutation in which each bit is flipped or not by a hash of the bits below it: Owen's scrambling of a number whose
// bits are reversed.
PT_HD inline std::uint32_t scramble_reversed(std::uint32_t x, std::uint32_t seed) {
    x ^= x * 0x3d20adeau;
    x += seed;
    x *= (seed >> 16) | 1u;
    x ^= x * 0x05526c56u;
    x ^= x * 0x53a22864u;
    return x;
}

PT_HD inline std::uint32_t owen_scramble(std::uint32_t x, std::uint32_t seed) {
    return reverse_bits(scramble_reversed(reverse_bits(x), seed));
}

// The first four coordinates of a Sobol' point, in units of 2^-32. Each column of a generator matrix follows from those
// before it by the dimension's primitive polynomial: 1, x + 1, x^2 + x + 1 and x^3 + x + 1.
PT_HD inline RandomWords sobol_point(std::uint32_t index) {
    RandomWords point{reverse_bits(index), 0, 0, 0};
    std::uint32_t y = 0x80000000u;
    std::uint32_t z_0 = 0x80000000u, z_1 = 0xc0000000u;
    std::uint32_t w_0 = 0x80000000u, w_1 = 0xc0000000u, w_2 = 0x20000000u;
    for (; index != 0; index >>= 1) {
        if ((index & 1u) != 0) {
            point.y ^= y;
            point.z ^= z_0;
            point.w ^= w_0;
        }
        y ^= y >> 1;
        const std::uint32_t z_2 = z_1 ^ z_0 ^ (z_0 >> 2);
        z_0 = z_1;
        z_1 = z_2;
        const std::uint32_t w_3 = w_1 ^ w_0 ^ (w_0 >> 3);
        w_0 = w_1;
        w_1 = w_2;
        w_2 = w_3;
    }
    return point;
}

// The random words that all samples of a pixel share at one place (bounce and block) of their paths.
PT_HD inline RandomWords words_of_dimension(const RandomWords& seed, const RandomKey& key) {
    return pcg4d({key.pixel ^ seed.x, key.bounce ^ seed.y, key.block ^ seed.z, 0x5bd1e995u ^ seed.w});
}

// The four random numbers of a key: point `sample` of the scrambled sequence that belongs to the rest of the key.
PT_HD inline RandomWords sobol_owen_words(const RandomWords& seed, const RandomKey& key) {
    const RandomWords of_dimension = words_of_dimension(seed, key);
    const std::uint32_t of_order = pcg4d(of_dimension).x;
    const RandomWords point = sobol_point(owen_scramble(key.sample, of_order));
    return {owen_scramble(point.x, of_dimension.x), owen_scramble(point.y, of_dimension.y),
            owen_scramble(point.z, of_dimension.z), owen_scramble(point.w, of_dimension.w)};
}

}  // namespace pt
