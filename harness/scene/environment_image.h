// Images that light comes from: Radiance .hdr, and .exr by OpenEXR 3, linear RGB.
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
    std::vector<Vec3<float>> texels;  // row-major from the top
    bool was_multiplied = false;      // in the file, by an exposure or a colour correction that it tells
};

// Most rows and columns: beyond these, rows would be less than a rounding of a cosine apart at the poles.
inline constexpr std::uint32_t most_environment_rows = 4096;
inline constexpr std::uint32_t most_environment_columns = 8192;

// Reads an image in the format of the file's ending. Throws InputError of one line for a file that is missing, of
// another kind, too large or broken, and for a texel that is negative, no number or infinite.
EnvironmentImage read_environment_image(const std::filesystem::path& path);

// Reads a Radiance file's content as read_environment_image does; `file` is for the messages.
EnvironmentImage parse_hdr(std::string_view content, const std::string& file);
// Reads an EXR file's content: channels R, G and B, or Y alone, of whatever type, as decode_exr has them.
EnvironmentImage parse_exr(std::string_view content, const std::string& file);

// The content of a file from which parse_exr reads this image.
std::string encode_environment_exr(const EnvironmentImage& image);

}  // namespace pt
