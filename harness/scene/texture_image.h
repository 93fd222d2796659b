// Decodes texture images: PNG (8 or 16 bits) and JPEG, by stb_image. Colours are converted from sRGB to linear RGB
// once; other values, such as roughness, are taken as linear.
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
    std::vector<Vec3<float>> texels;  // linear texels, 0 to 1 (normals: -1 to 1), bottom row first
};

// How texel values of an image file are read. `colour`: sRGB. `number`: the first channel, linear from 0 to 1.
// `normal`: each channel linear from -1 to 1 with 0 at 128 (16 bits: 32768), the value that programs write for a flat
// surface. A normal that does not point outward (z above 0) is replaced by the flat one, (0, 0, 1).
enum class TexelMeaning { colour, number, normal };

inline constexpr std::uint64_t largest_texture_file = std::uint64_t{1} << 28;  // bytes of a file; stb_image takes int
inline constexpr std::uint32_t most_texture_side = 8192;
// Most texels of all textures of a scene together: 3 GiB in single precision.
inline constexpr std::uint64_t most_texels = std::uint64_t{1} << 28;

// Reads a texture image in the format that the file's extension names. Throws InputError of one line for a file that is
// missing, of another kind, too large or broken.
TextureImage read_texture_image(const std::filesystem::path& path, TexelMeaning meaning = TexelMeaning::colour);

// While an ImagesToBe lives, `read_texture_image` reads each file only once, and images whose `contents` it holds, by
// path, need no file yet. Only one may live at a time.
class ImagesToBe {
public:
    using Contents = std::map<std::string, std::string>;
    explicit ImagesToBe(Contents contents = {});
    ~ImagesToBe();
    ImagesToBe(const ImagesToBe&) = delete;
    ImagesToBe& operator=(const ImagesToBe&) = delete;
};

// Decodes the content of a PNG or JPEG file; `file` is the name that error messages show. An alpha channel is ignored,
// and a grey image fills all three channels.
TextureImage parse_texture_image(std::string_view content, const std::string& file,
                                 TexelMeaning meaning = TexelMeaning::colour);

// Whether an image file's content has an alpha channel. The content must be one that `parse_texture_image` can decode.
bool texture_has_alpha(std::string_view content);

// The linear value of an sRGB value from 0 to 1 (IEC 61966-2-1).
double srgb_to_linear(double encoded);

}  // namespace pt
