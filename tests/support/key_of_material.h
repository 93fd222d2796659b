// What a program with sort_key=material says of its keys, for kernels that run on host threads: a material and no more.
#pragma once

#include <cstdint>

namespace sort_key {
inline constexpr bool by_chunk = false;
template <class Ray, class Hit, class Bounds>
std::uint32_t rest(const Ray&, const Hit&, const Bounds&) {
    return 0;
}
}  // namespace sort_key
