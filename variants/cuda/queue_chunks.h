// The chunks of a queue's slots within which sort_key=chunk_material sorts paths. Host side.
#pragma once

#include <algorithm>
#include <cstdint>

#include "variants/cuda/device/counting_sort.h"

namespace pt::cuda {

// Number of chunks in a queue; the last one may be shorter.
constexpr std::uint32_t chunks_of(std::uint32_t capacity, std::uint32_t chunk) {
    return capacity / chunk + (capacity % chunk != 0 ? 1 : 0);
}

// Number of sort keys that live paths may have: for each chunk, one for every material and one for "missed". All other
// slots get this number as their key.
constexpr std::uint32_t keys_of_chunks(std::uint32_t capacity, std::uint32_t materials, std::uint32_t chunk) {
    return chunks_of(capacity, chunk) * (materials + 1);
}

// Number of slots in a chunk: as many as the tunable asks for, or the fewest with which a counting sort can count the
// keys of all chunks and the last key. One chunk is always allowed: with more materials than a counting sort counts, it
// is no worse off than a sort by material alone.
constexpr std::uint32_t slots_of_chunk(std::uint32_t capacity, std::uint32_t materials, std::uint32_t asked) {
    const std::uint32_t most_chunks = std::max(1u, (most_bucket_keys - 1) / (materials + 1));
    return std::max(asked, chunks_of(capacity, most_chunks));
}

}  // namespace pt::cuda
