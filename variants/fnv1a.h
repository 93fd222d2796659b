// FNV-1a with 64 bits (Fowler, Noll and Vo; RFC 9923): the hash of films, scenes, meshes, texts and programs. It tells
// contents apart that differ by accident, and guards against no one who wants two to be equal.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace pt {

inline constexpr std::uint64_t fnv1a_start = 0xcbf29ce484222325ull;

// Extends an FNV-1a hash by one byte, or by any other unit.
constexpr std::uint64_t fnv1a_step(std::uint64_t hash, std::uint64_t unit) { return (hash ^ unit) * 0x100000001b3ull; }

constexpr std::uint64_t fnv1a(std::string_view text, std::uint64_t start = fnv1a_start) {
    std::uint64_t hash = start;
    for (const char c : text) {
        hash = fnv1a_step(hash, static_cast<unsigned char>(c));
    }
    return hash;
}

inline std::uint64_t fnv1a_of_bytes(const void* data, std::size_t bytes, std::uint64_t start = fnv1a_start) {
    return fnv1a(std::string_view(static_cast<const char*>(data), bytes), start);
}

// Extends an FNV-1a hash by a 64-bit word and folds the upper half of the result into the lower one: an eighth of the
// steps of single bytes, for films and meshes of hundreds of megabytes.
constexpr std::uint64_t fnv1a_word(std::uint64_t hash, std::uint64_t word) {
    const std::uint64_t next = fnv1a_step(hash, word);
    return next ^ next >> 32;
}

}  // namespace pt
