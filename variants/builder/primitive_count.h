// How many primitives one tree may hold: references are numbered in 27 bits of a link (variants/bvh/link.h).
#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>

#include "variants/bvh/link.h"

namespace pt::builder {

inline void require_primitive_count(std::size_t count) {
    if (count > max_slots) {
        throw std::length_error("a tree of " + std::to_string(count) + " primitives; at most " +
                                std::to_string(max_slots) + " are allowed");
    }
}

}  // namespace pt::builder
