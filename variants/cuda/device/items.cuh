// What a warp that goes through the image is given: samples of a strip of 32 pixels.
#pragma once

#include "variants/cuda/device/device.cuh"

// Items 0 to count - 1 of a strip of 32 pixels: item i is pixel first_pixel + i mod 32, sample first_sample +
// (i / 32) * sample_stride. A strip may reach beyond the last pixel; such items are passed over.
struct Items {
    std::uint32_t count;
    std::uint32_t pixels;  // number of pixels that this device renders
    std::uint32_t width;   // width of the image
    pt::PixelPlace first;  // first pixel of the strip, among the pixels of this device
    std::uint32_t first_sample, sample_stride;

    __device__ bool exists(std::uint32_t item) const { return item < count && first.index + item % warp_size < pixels; }
    // Pixel of item number `item` of a strip. The division by the image's width is made once a strip, not once a path.
    __device__ pt::PixelPlace place(std::uint32_t item) const {
        const std::uint32_t step = item % warp_size;
        const std::uint32_t x = first.x + step;
        const bool wraps = x >= width;
        if (width < warp_size) {
            return pt::PixelPlace::of(first.index + step, width);
        }
        return {first.index + step, wraps ? x - width : x, first.y + (wraps ? 1u : 0u)};
    }
    __device__ std::uint32_t sample(std::uint32_t item) const {
        return first_sample + item / warp_size * sample_stride;
    }
};
