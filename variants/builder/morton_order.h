// Primitives in Morton order, which bottom-up builders start from.
#pragma once

#include <cstdint>
#include <vector>

#include "variants/bvh/binary_tree.h"

namespace pt::builder {

// Sorted Morton keys of the boxes' centres (variants/bvh/morton.h); a key's low half is its primitive.
std::vector<std::uint64_t> morton_keys(const PrimitiveBoxes& boxes);

inline std::uint32_t primitive_of(std::uint64_t key) { return static_cast<std::uint32_t>(key); }

}  // namespace pt::builder
