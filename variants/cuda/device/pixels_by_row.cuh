// Which pixels a program's threads render: every n-th row of the image, as one of several devices has them
// (partition=tiles). Threads number the device's own pixels from 0, row-major; paths and the film have the image's
// numbers.
#pragma once

#include "kernels/camera.h"

extern "C" {
// First row, step from row to row, and number of the device's own pixels, which the host sets.
__constant__ unsigned pt_rows[3];
}

namespace pt::cuda {

template <class Scene>
__device__ inline std::uint32_t own_pixels(const Scene&) {
    return pt_rows[2];
}
__device__ inline PixelPlace in_image(const PixelPlace& own, std::uint32_t width) {
    const std::uint32_t y = pt_rows[0] + own.y * pt_rows[1];
    return {y * width + own.x, own.x, y};
}
__device__ inline std::uint32_t image_pixel(std::uint32_t own, std::uint32_t width) {
    return in_image(PixelPlace::of(own, width), width).index;
}

}  // namespace pt::cuda
