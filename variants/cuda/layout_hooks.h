// A layout on the device as the host asks it: by the size of a Real, which it knows at run time only.
#pragma once

#include "variants/cuda/hooks.h"

namespace pt::cuda {

template <template <class Real> class Paths>
constexpr Layout layout_hooks() {
    return {.bytes =
                [](std::uint32_t capacity, std::size_t real_bytes, const PathFields& fields) {
                    return real_bytes == sizeof(float) ? Paths<float>::bytes(capacity, fields)
                                                       : Paths<double>::bytes(capacity, fields);
                },
            .segment =
                [](const PathStore& store, std::size_t real_bytes) {
                    return real_bytes == sizeof(float) ? Paths<float>(store).segment() : Paths<double>(store).segment();
                },
            .origin_surface =
                [](const PathStore& store, std::size_t real_bytes) {
                    return real_bytes == sizeof(float) ? Paths<float>(store).origin_surface()
                                                       : Paths<double>(store).origin_surface();
                }};
}

}  // namespace pt::cuda
