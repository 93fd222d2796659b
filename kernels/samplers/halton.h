// Halton points: coordinate d of sample i is the radical inverse of i in base p(d), the d-th prime. Each pixel maps
// every digit to a digit + b, modulo p, with a and b of its own: two different digits may become any two, where a shift
// b alone would leave the first samples side by side in large bases. Dimensions are not padded: every random number of
// a path has its own, up to the 15th surface hit; beyond it, and within bodies, numbers are pcg4d's. Halton, Numerische
// Mathematik 2, 1960; random linear digit scrambling: Matousek, "On the L2-discrepancy for anchored boxes", J.
// Complexity 14(4), 1998.
#pragma once

#include "kernels/random_words.h"

namespace pt {

inline constexpr std::uint32_t halton_dimensions = 128;

PT_HD inline std::uint32_t prime_number(std::uint32_t index) {
    static constexpr std::uint16_t primes[halton_dimensions] = {
        2,   3,   5,   7,   11,  13,  17,  19,  23,  29,  31,  37,  41,  43,  47,  53,  59,  61,  67,  71,  73,  79,
        83,  89,  97,  101, 103, 107, 109, 113, 127, 131, 137, 139, 149, 151, 157, 163, 167, 173, 179, 181, 191, 193,
        197, 199, 211, 223, 227, 229, 233, 239, 241, 251, 257, 263, 269, 271, 277, 281, 283, 293, 307, 311, 313, 317,
        331, 337, 347, 349, 353, 359, 367, 373, 379, 383, 389, 397, 401, 409, 419, 421, 431, 433, 439, 443, 449, 457,
        461, 463, 467, 479, 487, 491, 499, 503, 509, 521, 523, 541, 547, 557, 563, 569, 571, 577, 587, 593, 599, 601,
        607, 613, 617, 619, 631, 641, 643, 647, 653, 659, 661, 673, 677, 683, 691, 701, 709, 719};
    return primes[index];
}

// Scales a random word of 32 bits to a whole number in [0, count).
PT_HD inline std::uint32_t scaled_to(std::uint32_t count, std::uint32_t word) {
    return static_cast<std::uint32_t>((std::uint64_t{word} * count) >> 32);
}

// Scrambled radical inverse of `index` in units of 2^-32, of as many digits as 32 bits resolve, each scrambled by
// `seed`. Rounded up, so that a point at the lower end of an elementary interval stays within it.
PT_HD inline std::uint32_t scrambled_radical_inverse(std::uint32_t index, std::uint32_t base, std::uint32_t seed) {
    std::uint64_t mirrored = 0, scale = 1;
    for (; scale * base <= (std::uint64_t{1} << 32); scale *= base) {
        const std::uint32_t offset = scaled_to(base, seed);
        seed = seed * 1664525u + 1013904223u;
        const std::uint32_t factor = 1 + scaled_to(base - 1, seed);
        seed = seed * 1664525u + 1013904223u;
        mirrored = mirrored * base + (factor * (index % base) + offset) % base;
        index /= base;
    }
    return static_cast<std::uint32_t>(((mirrored << 32) + scale - 1) / scale);
}

PT_HD inline RandomWords halton_words(const RandomWords& seed, const RandomKey& key) {
    const std::uint32_t block = key.bounce == 0 ? key.block : 2 * key.bounce + key.block;
    const bool has_dimensions = key.block < 2 && 4 * block < halton_dimensions;
    if (!has_dimensions) {
        return pcg4d_words(seed, key);
    }
    const RandomWords scramble =
        pcg4d({key.pixel ^ seed.x, key.bounce ^ seed.y, key.block ^ seed.z, 0x85ebca6bu ^ seed.w});
    return {scrambled_radical_inverse(key.sample, prime_number(4 * block), scramble.x),
            scrambled_radical_inverse(key.sample, prime_number(4 * block + 1), scramble.y),
            scrambled_radical_inverse(key.sample, prime_number(4 * block + 2), scramble.z),
            scrambled_radical_inverse(key.sample, prime_number(4 * block + 3), scramble.w)};
}

}  // namespace pt
