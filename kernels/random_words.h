// Interface of all samplers: four random 32-bit words for a key.
#pragma once

#include "kernels/math.h"

namespace pt {

struct RandomWords {
    std::uint32_t x, y, z, w;
};

struct RandomKey {
    std::uint32_t pixel, sample, bounce, block;
};

// pcg4d: Jarzynski and Olano, "Hash Functions for GPU Rendering", JCGT 9(3), 2020. A bijection of 128 bits.
PT_HD inline RandomWords pcg4d(RandomWords v) {
    v.x = v.x * 1664525u + 1013904223u;
    v.y = v.y * 1664525u + 1013904223u;
    v.z = v.z * 1664525u + 1013904223u;
    v.w = v.w * 1664525u + 1013904223u;
    v.x += v.y * v.w;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v.w += v.y * v.z;
    v.x ^= v.x >> 16;
    v.y ^= v.y >> 16;
    v.z ^= v.z >> 16;
    v.w ^= v.w >> 16;
    v.x += v.y * v.w;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v.w += v.y * v.z;
    return v;
}

PT_HD inline RandomWords pcg4d_words(const RandomWords& seed, const RandomKey& key) {
    return pcg4d({key.pixel ^ seed.x, key.sample ^ seed.y, key.bounce ^ seed.z, key.block ^ seed.w});
}

}  // namespace pt
