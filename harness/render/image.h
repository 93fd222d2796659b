// Writes an image as PNG (sRGB, 8 bit, clipped at 1), PFM or EXR (linear float), by the file's ending.
#pragma once

#include <string>

#include "harness/render/film.h"

namespace pt {

// Throws InputError for another ending, MachineError if the file cannot be written. The file appears whole or not at
// all.
void write_image(const Film& film, const std::string& file);
// Throws InputError unless it ends in .png, .pfm or, where there is OpenEXR, .exr.
void check_image_name(const std::string& file);

// Writes linear RGB, row-major from the top, as .pfm.
void write_pfm(const std::vector<float>& radiance, std::uint32_t width, std::uint32_t height, const std::string& file);

}  // namespace pt
