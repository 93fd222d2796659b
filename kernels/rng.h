// Keyed random numbers: u = hash(seed; pixel, sample, bounce, dimension). Nothing depends on a position in a queue, so
// compaction, sorting and scheduling cannot change an image.
// The hash is pcg4d unless the kernel's features name another source. pcg4d is a bijection of the 128-bit key, so
// within one seed no two keys share their four words.
#pragma once

#include "kernels/pick_header.h"
#include "kernels/sampler_list.h"

#define PT_SAMPLER_STEM(name) name,
#define PT_SAMPLER_FILE(n) PT_FILE_AT(n, samplers, PT_SAMPLERS(PT_SAMPLER_STEM) PT_NO_MORE)

#include PT_SAMPLER_FILE(0)
#include PT_SAMPLER_FILE(1)
#include PT_SAMPLER_FILE(2)
#include PT_SAMPLER_FILE(3)
#include PT_SAMPLER_FILE(4)
#include PT_SAMPLER_FILE(5)
#include PT_SAMPLER_FILE(6)
#include PT_SAMPLER_FILE(7)

#undef PT_SAMPLER_STEM

namespace pt {

static_assert(sampler_count <= 8, "kernels/rng.h includes, and kernels/config.h has bits for, 8 samplers");

// Seed of the random numbers: four whitening words from the user's seed, and the sampler of a kernel with several.
struct RandomSeed {
    RandomWords words{0, 0, 0, 0};
    FeatureSet sampler = no_features;  // feature of the sampler: one of `samplers`, or none for pcg4d

    PT_HD static RandomSeed from(std::uint64_t seed) {
        return {
            pcg4d({static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32), 0x9e3779b9u, 0x7f4a7c15u}),
            no_features};
    }
};

// Dimension map of the random numbers. A purpose owns its place whether or not the scene or the variant uses it, so a
// kernel that leaves a feature out sees the same numbers as one that has it. Bounce 0 is the camera; bounce k the k-th
// surface hit. A block is one hash: four numbers.
//   camera   block 0: pixel x, pixel y, lens u, lens v      block 1: time, -, -, -
//   surface  block 0: lobe or Fresnel, direction u (a guided walk: its first step's densities), direction v, Russian
//            roulette
//            block 1: light index, light point u, light point v, light face
//   walk     block 2 + step: free path, colour channel (a guided walk: the next step's densities), phase cosine or
//            Fresnel, phase azimuth
namespace random_block {
inline constexpr std::uint32_t camera_position = 0;
inline constexpr std::uint32_t camera_time = 1;
inline constexpr std::uint32_t scatter = 0;
inline constexpr std::uint32_t light = 1;
inline constexpr std::uint32_t walk = 2;
}  // namespace random_block

// The sampler that the kernel's random numbers come from: one of `samplers`, or none for pcg4d.
template <class Config>
PT_HD inline FeatureSet sampler_of(const RandomSeed& seed) {
    constexpr FeatureSet compiled = Config::features & samplers;
    constexpr bool is_chosen_at_run_time = (compiled & (compiled - 1u)) != 0;
    return is_chosen_at_run_time ? seed.sampler : compiled;
}

template <class Config>
PT_HD inline RandomWords random_words(const RandomSeed& seed, const RandomKey& key) {
    const FeatureSet sampler = sampler_of<Config>(seed);
#define PT_DRAW(name)                                                     \
    if (has<Config>(Feature::name) && contains(sampler, Feature::name)) { \
        return name##_words(seed.words, key);                             \
    }
    PT_SAMPLERS(PT_DRAW)
#undef PT_DRAW
    return pcg4d_words(seed.words, key);
}

// Uniform number in [0, 1) from 32 random bits: never 1, whatever the rounding mode.
template <class Real>
PT_HD constexpr Real unit_interval(std::uint32_t bits) {
    if constexpr (sizeof(Real) == 4) {
        return static_cast<Real>(bits >> 8) * Real(0x1p-24);
    } else {
        return static_cast<Real>(bits) * Real(0x1p-32);
    }
}

// Uniform number in [-1, 1) from 32 random bits: exactly 2 unit_interval(bits) - 1, but with one rounding fewer.
template <class Real>
PT_HD constexpr Real symmetric_interval(std::uint32_t bits) {
    if constexpr (sizeof(Real) == 4) {
        return static_cast<Real>(bits >> 8) * Real(0x1p-23) - Real(1);
    } else {
        return static_cast<Real>(bits) * Real(0x1p-31) - Real(1);
    }
}

// Uniform number in (0, 1] from all 32 random bits, for -log(u): the longest free path is 22.9 mean free paths instead
// of the 16.6 that 24 bits would allow.
template <class Real>
PT_HD constexpr Real positive_unit_interval(std::uint32_t bits) {
    return (static_cast<Real>(bits) + Real(0.5)) * Real(0x1p-32);
}

}  // namespace pt
