// Which pixels a program's threads render: all of the image, each under its own number.
#pragma once

#include "kernels/camera.h"

namespace pt::cuda {

template <class Scene>
__device__ inline std::uint32_t own_pixels(const Scene& scene) {
    return scene.pixel_count();
}
__device__ inline PixelPlace in_image(const PixelPlace& own, std::uint32_t) { return own; }
__device__ inline std::uint32_t image_pixel(std::uint32_t own, std::uint32_t) { return own; }

}  // namespace pt::cuda
