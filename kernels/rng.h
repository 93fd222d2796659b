// Keyed random numbers: u = hash(seed; pixel, sample, bounce, dimension). Nothing depends on a position in a queue, so
// compaction, sorting and scheduling cannot change an image.
// The hash is pcg4d: Jarzynski and Olano, "Hash Functions for GPU Rendering", JCGT 9(3), 2020. It is a bijection of the
// 128-bit key, so within one seed no two keys share their four words.
#pragma once

#include "kernels/config.h"
#include "kernels/math.h"

namespace pt {

struct RandomWords {
    std::uint32_t x, y, z, w;
};

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

// Four whitening words derived from the user's seed.
struct RandomSeed {
    RandomWords words{0, 0, 0, 0};

    PT_HD static RandomSeed from(std::uint64_t seed) {
        return {pcg4d(
            {static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32), 0x9e3779b9u, 0x7f4a7c15u})};
    }
};

// The dimension map. A purpose owns its place whether or not the scene or the variant uses it, so a kernel that leaves
// a feature out sees the same numbers as one that has it. Bounce 0 is the camera; bounce k the k-th surface hit.
// A block is one hash: four numbers.
//   camera   block 0: pixel x, pixel y, lens u, lens v      block 1: time, -, -, -
//   surface  block 0: lobe or Fresnel, direction u, direction v, Russian roulette
//            block 1: light index, light point u, light point v, light face
//   walk     block 2 + step: free path, colour channel, phase cosine or Fresnel, phase azimuth
namespace random_block {
inline constexpr std::uint32_t camera_position = 0;
inline constexpr std::uint32_t camera_time = 1;
inline constexpr std::uint32_t scatter = 0;
inline constexpr std::uint32_t light = 1;
inline constexpr std::uint32_t walk = 2;
}  // namespace random_block

struct RandomKey {
    std::uint32_t pixel, sample, bounce, block;
};

PT_HD inline RandomWords random_words(const RandomSeed& seed, RandomKey key) {
    return pcg4d(
        {key.pixel ^ seed.words.x, key.sample ^ seed.words.y, key.bounce ^ seed.words.z, key.block ^ seed.words.w});
}

// A number in [0, 1): never 1, whatever the rounding mode.
template <class Real>
PT_HD constexpr Real unit_interval(std::uint32_t bits) {
    if constexpr (sizeof(Real) == 4) {
        return static_cast<Real>(bits >> 8) * Real(0x1p-24);
    } else {
        return static_cast<Real>(bits) * Real(0x1p-32);
    }
}

// A number in (0, 1] from all 32 bits, for -log(u): the longest free path is 22.9 mean free paths instead of the 16.6
// that 24 bits would allow.
template <class Real>
PT_HD constexpr Real positive_unit_interval(std::uint32_t bits) {
    return (static_cast<Real>(bits) + Real(0.5)) * Real(0x1p-32);
}

}  // namespace pt
