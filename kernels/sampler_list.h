// The samplers that a kernel has only where it is asked for one, listed once; every kernel has pcg4d. A sampler is a
// header in kernels/samplers/, a file in variants/sampler/ and a line in this list.
#pragma once

#include <cstdint>

// SAMPLER(name): the name of the sampler's header and of its Feature. The header defines `name_words(seed, key)`, which
// returns four random 32-bit words. A kernel with several samplers asks for them in the order of the lines.
#define PT_SAMPLERS(SAMPLER) \
    SAMPLER(philox)          \
    SAMPLER(sobol_owen)      \
    SAMPLER(sobol_rotated)   \
    SAMPLER(pmj02)           \
    SAMPLER(halton)          \
    SAMPLER(minstd)

namespace pt {

#define PT_SAMPLER_KIND(name) name,
enum class SamplerKind : std::uint32_t { PT_SAMPLERS(PT_SAMPLER_KIND) };
#undef PT_SAMPLER_KIND

#define PT_COUNT(name) +1u
inline constexpr std::uint32_t sampler_count = 0u PT_SAMPLERS(PT_COUNT);
#undef PT_COUNT

}  // namespace pt
