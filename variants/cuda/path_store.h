// What the layouts on the device build on, for NVRTC, nvcc and the host compiler alike.
#pragma once

#include "kernels/intersect.h"

#if defined(__CUDACC_RTC__)

namespace pt::cuda {
struct PathStore {
    unsigned char* base;
    std::uint32_t capacity;
};
struct FieldView {
    const unsigned char* base;
    std::uint32_t stride;
};
}  // namespace pt::cuda

#if !defined(offsetof)
#define offsetof(type, member) __builtin_offsetof(type, member)
#endif

#else

#include <cstddef>

#include "variants/cuda/hooks.h"
#include "variants/descriptor.h"

#endif

namespace pt::cuda {

PT_HD inline std::uint32_t value_at(const FieldView& field, std::uint32_t slot) {
    return *reinterpret_cast<const std::uint32_t*>(field.base + static_cast<std::size_t>(field.stride) * slot);
}

}  // namespace pt::cuda
