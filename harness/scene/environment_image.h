// Environment maps: images in linear RGB that light a scene, read from Radiance .hdr or from .exr (OpenEXR 3).
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "kernels/math.h"

namespace pt {

struct EnvironmentImage {
    std::uint32_t width = 0, height = 0;
    std::vector<Vec3<float>> texels;  // texels of the map row by row, the top row first
    bool was_multiplied = false;      // whether the .hdr header gives an exposure or colour correction
};

// Largest environment map, in texels: with more rows, cosines at the poles would lie within a rounding of each other.
inline constexpr std::uint32_t most_environment_rows = 4096;
inline constexpr std::uint32_t most_environment_columns = 8192;

// Reads an environment map in the format that the file's extension names. Throws InputError of one line for a file that
// is missing, of another kind, too large or broken, and for a texel that is negative, no number or infinite.
EnvironmentImage read_environment_image(const std::filesystem::path& path);

// Reads an environment map from the content of a Radiance .hdr file; `file` is the name that error messages show.
EnvironmentImage parse_hdr(std::string_view content, const std::string& file);
// Reads an environment map from the content of an EXR file: channels R, G and B, or Y alone, of any pixel type.
EnvironmentImage parse_exr(std::string_view content, const std::string& file);

// Encodes an environment map as the content of an EXR file, which `parse_exr` reads back as the same image.
std::string encode_environment_exr(const EnvironmentImage& image);

}  // namespace pt
