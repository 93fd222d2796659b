// Philox4x32-10: ten rounds of multiplications and exclusive ors over a 128-bit counter with a 64-bit key. The
// reference sampler: it passes every test of randomness that is in use, at some cost.
// Salmon, Moraes, Dror and Shaw, "Parallel Random Numbers: As Easy as 1, 2, 3", SC 2011.
#pragma once

#include "kernels/random_words.h"

namespace pt {

PT_HD inline RandomWords philox4x32_10(RandomWords counter, std::uint32_t key_0, std::uint32_t key_1) {
    for (int round = 0; round < 10; ++round) {
        const std::uint64_t a = std::uint64_t{0xd2511f53u} * counter.x;
        const std::uint64_t b = std::uint64_t{0xcd9e8d57u} * counter.z;
        counter = {static_cast<std::uint32_t>(b >> 32) ^ counter.y ^ key_0, static_cast<std::uint32_t>(b),
                   static_cast<std::uint32_t>(a >> 32) ^ counter.w ^ key_1, static_cast<std::uint32_t>(a)};
        key_0 += 0x9e3779b9u;
        key_1 += 0xbb67ae85u;
    }
    return counter;
}

PT_HD inline RandomWords philox_words(const RandomWords& seed, const RandomKey& key) {
    return philox4x32_10({key.pixel, key.sample, key.bounce, key.block}, seed.x, seed.y);
}

}  // namespace pt
