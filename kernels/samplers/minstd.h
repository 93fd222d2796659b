// Random numbers as in the path tracers of CIS 565: a short linear congruential generator, seeded anew for every path
// and bounce by a hash of the sample index and of the path's place in the queue. Kept to measure what that costs: the
// streams overlap, and whatever moves a path changes its numbers. Park and Miller's minstd with Stockmeyer's multiplier
// (thrust::default_random_engine) and Wang's integer hash (makeSeededRandomEngine of CIS 565).
#pragma once

#include "kernels/random_words.h"

namespace pt {

inline constexpr std::uint32_t minstd_multiplier = 48271u;
inline constexpr std::uint32_t minstd_modulus = 2147483647u;  // modulus: the prime 2^31 - 1

PT_HD constexpr std::uint32_t minstd_product(std::uint32_t a, std::uint32_t b) {
    return static_cast<std::uint32_t>(static_cast<std::uint64_t>(a) * b % minstd_modulus);
}

// The minstd multiplier to the power n, modulo the modulus.
PT_HD constexpr std::uint32_t minstd_power(std::uint32_t n) {
    std::uint32_t power = 1;
    for (std::uint32_t square = minstd_multiplier; n != 0; n >>= 1) {
        power = (n & 1u) != 0 ? minstd_product(power, square) : power;
        square = minstd_product(square, square);
    }
    return power;
}

PT_HD constexpr std::uint32_t wang_hash(std::uint32_t a) {
    a = (a + 0x7ed55d16u) + (a << 12);
    a = (a ^ 0xc761c23cu) ^ (a >> 19);
    a = (a + 0x165667b1u) + (a << 5);
    a = (a + 0xd3a2646cu) ^ (a << 9);
    a = (a + 0xfd7046c5u) + (a << 3);
    return (a ^ 0xb55a4f09u) ^ (a >> 16);
}

// Numbers 4 b to 4 b + 3 of a minstd sequence, b the key's block, each of 31 bits and shifted up by one: never 1 in the
// unit interval, while Thrust's distribution rounds to 1 once in 3e7.
PT_HD inline RandomWords minstd_words(const RandomWords& seed, const RandomKey& key) {
    const std::uint32_t hash = wang_hash((1u << 31) | (key.bounce << 22) | key.sample) ^ wang_hash(key.pixel) ^ seed.x;
    std::uint32_t state = hash % minstd_modulus;
    state = minstd_product(state == 0 ? 1u : state, minstd_power(4 * key.block));
    const auto draw = [&]() {
        state = minstd_product(state, minstd_multiplier);
        return (state - 1u) << 1;
    };
    RandomWords words;
    words.x = draw();
    words.y = draw();
    words.z = draw();
    words.w = draw();
    return words;
}

}  // namespace pt
