// Storage of paths, on which the layouts on the device build, for NVRTC, nvcc and the host compiler alike.
#pragma once

#include <cstddef>

#include "kernels/intersect.h"
#include "kernels/path_fields.h"

namespace pt::cuda {

// The paths of a queue in device memory: one block whose inner order is the layout's.
struct PathStore {
    unsigned char* base = nullptr;
    std::uint32_t capacity = 0;  // number of path slots in the store
};

// One 32-bit field of the paths of a store, whatever the layout: slot i is at base + i * stride.
struct FieldView {
    const unsigned char* base = nullptr;
    std::uint32_t stride = 0;  // bytes from the field of one slot to that of the next
};

PT_HD inline std::uint32_t value_at(const FieldView& field, std::uint32_t slot) {
    return *reinterpret_cast<const std::uint32_t*>(field.base + static_cast<std::size_t>(field.stride) * slot);
}

}  // namespace pt::cuda
