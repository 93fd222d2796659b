// Writes images by the file's extension: PNG (sRGB, 8 bits, clipped at 1), PFM or EXR (linear floats).
#pragma once

#include <string>

#include "harness/render/film.h"

namespace pt {

// Writes the film as an image, atomically. Throws InputError for an unknown extension, MachineError if writing fails.
void write_image(const Film& film, const std::string& file);
// Throws InputError unless the file name ends in .png, .pfm or, in a build with OpenEXR, .exr.
void check_image_name(const std::string& file);

// Writes linear RGB, row-major from the top, as a .pfm file.
void write_pfm(const std::vector<float>& radiance, std::uint32_t width, std::uint32_t height, const std::string& file);

}  // namespace pt
