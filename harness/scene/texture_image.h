// Images that surfaces show: PNG (8 or 16 bits) and JPEG, by stb_image. Colours are sRGB, decoded to linear RGB once;
// other numbers are taken as they are.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "kernels/math.h"

namespace pt {

struct TextureImage {
    std::uint32_t width = 0, height = 0;
    std::vector<Vec3<float>> texels;  // linear, from 0 to 1, of normals from -1; row-major from the bottom
};

// What a file's numbers are: sRGB colours; one number a texel: the first channel, as all three, linear from 0 to 1; or
// normals: each channel linear from -1 to 1, by way of 0 at 128 (of 16 bits at 32768), which no other rule makes of
// what programs write for a flat surface. A normal that does not point outward (z above 0) is taken for a flat one, (0,
// 0, 1).
enum class TexelMeaning { colour, number, normal };

inline constexpr std::uint64_t largest_texture_file = std::uint64_t{1} << 28;  // in bytes: stb_image has an int of them
inline constexpr std::uint32_t most_texture_side = 8192;
// Most texels of all images of a scene together: 3 GiB of single precision numbers.
inline constexpr std::uint64_t most_texels = std::uint64_t{1} << 28;

// Reads an image in the format of the file's ending. Throws InputError of one line for a file that is missing, of
// another kind, too large or broken.
TextureImage read_texture_image(const std::filesystem::path& path, TexelMeaning meaning = TexelMeaning::colour);

// While one lives, read_texture_image reads each file once, and those of these contents, by path, need not be written
// yet. One at a time.
class ImagesToBe {
public:
    using Contents = std::map<std::string, std::string>;
    explicit ImagesToBe(Contents contents = {});
    ~ImagesToBe();
    ImagesToBe(const ImagesToBe&) = delete;
    ImagesToBe& operator=(const ImagesToBe&) = delete;
};

// Reads an image file's content as read_texture_image does; `file` is for the messages. An alpha channel is passed
// over, grey is three channels.
TextureImage parse_texture_image(std::string_view content, const std::string& file,
                                 TexelMeaning meaning = TexelMeaning::colour);

// Whether an image of these bytes, which parse_texture_image can read, says how much of each texel is seen through.
bool texture_has_alpha(std::string_view content);

// The linear value of an sRGB value from 0 to 1 (IEC 61966-2-1).
double srgb_to_linear(double encoded);

}  // namespace pt
