// The sources that NVRTC compiles, embedded in the binary: kernels/, the device's part of integrators, and the few GLM
// headers that kernels include.
#pragma once

#include <span>
#include <string_view>

namespace pt::cuda {

struct EmbeddedSource {
    std::string_view name;  // as included, e.g. "kernels/shade.h"
    std::string_view text;
};

// The sources; cmake/embed_sources.cmake generates this function at build time.
std::span<const EmbeddedSource> embedded_sources();

}  // namespace pt::cuda
