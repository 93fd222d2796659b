#include "harness/scene/texture_image.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "harness/json_reader.h"

#define STBI_ONLY_PNG
#define STBI_ONLY_JPEG
#define STBI_NO_STDIO
#define STBI_MAX_DIMENSIONS 65536
#define STB_IMAGE_IMPLEMENTATION
#include <stb/stb_image.h>

namespace pt {

namespace {

struct FreePixels {
    void operator()(void* pixels) const { stbi_image_free(pixels); }
};

[[noreturn]] void refuse_texture(const std::string& file, const std::string& found) {
    throw InputError(file, "content", found, "a whole PNG or JPEG image");
}

// Whether a JPEG is truncated, which stb_image hides by filling up the image. In a whole JPEG an end-of-image marker
// comes after the start of the last scan.
bool ends_early(std::string_view content) {
    constexpr std::string_view jpeg = "\xff\xd8", scan = "\xff\xda", end = "\xff\xd9";
    if (!content.starts_with(jpeg)) {
        return false;
    }
    const std::size_t last_end = content.rfind(end);
    const std::size_t last_scan = content.rfind(scan);
    return last_end == std::string_view::npos || (last_scan != std::string_view::npos && last_scan > last_end);
}

// Lookup table of the linear value of each value that an image channel can store.
template <class Channel>
std::vector<float> linear_channel(TexelMeaning meaning) {
    constexpr std::size_t most = std::numeric_limits<Channel>::max(), middle = most / 2 + 1;
    std::vector<float> linear(most + 1);
    for (std::size_t i = 0; i <= most; ++i) {
        const double share = static_cast<double>(i) / static_cast<double>(most);
        const double signed_share =
            std::max(-1.0, (static_cast<double>(i) - static_cast<double>(middle)) / static_cast<double>(middle - 1));
        linear[i] = static_cast<float>(meaning == TexelMeaning::colour   ? srgb_to_linear(share)
                                       : meaning == TexelMeaning::number ? share
                                                                         : signed_share);
    }
    return linear;
}

// Converts decoded pixels to linear texels, bottom row first.
template <class Channel>
std::vector<Vec3<float>> linear_texels(const Channel* channels, std::uint32_t width, std::uint32_t height,
                                       TexelMeaning meaning) {
    const std::vector<float> linear = linear_channel<Channel>(meaning);
    std::vector<Vec3<float>> texels;
    texels.reserve(std::size_t{width} * height);
    for (std::uint32_t row = height; row-- > 0;) {
        const Channel* channel = channels + std::size_t{3} * width * row;
        for (std::uint32_t column = 0; column < width; ++column, channel += 3) {
            const Vec3<float> all(linear[channel[0]], linear[channel[1]], linear[channel[2]]);
            const bool is_inward = meaning == TexelMeaning::normal && !(all.z > 0);
            texels.emplace_back(meaning == TexelMeaning::number ? Vec3<float>(all.x)
                                : is_inward                     ? Vec3<float>(0, 0, 1)
                                                                : all);
        }
    }
    return texels;
}

struct ImagesAtHand {
    bool is_alive = false;
    ImagesToBe::Contents contents;
    std::map<std::pair<std::string, TexelMeaning>, TextureImage> read;
};

ImagesAtHand& images_at_hand() {
    static ImagesAtHand images;
    return images;
}

TextureImage read_image_file(const std::filesystem::path& path, TexelMeaning meaning) {
    const std::string file = path.string();
    const std::string ending = ending_of(path);
    if (ending != ".png" && ending != ".jpg" && ending != ".jpeg") {
        throw InputError(file, "file name", fmt::format("the ending \"{}\"", ending), ".png, .jpg or .jpeg");
    }
    const auto to_be = images_at_hand().contents.find(file);
    return to_be != images_at_hand().contents.end()
               ? parse_texture_image(to_be->second, file, meaning)
               : parse_texture_image(read_file(file, largest_texture_file), file, meaning);
}

}  // namespace

ImagesToBe::ImagesToBe(Contents contents) {
    images_at_hand() = {.is_alive = true, .contents = std::move(contents), .read = {}};
}

ImagesToBe::~ImagesToBe() { images_at_hand() = {}; }

double srgb_to_linear(double encoded) {
    return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

TextureImage parse_texture_image(std::string_view content, const std::string& file, TexelMeaning meaning) {
    if (content.size() > largest_texture_file) {
        refuse_texture(file, fmt::format("{} bytes", content.size()));
    }
    const auto* const bytes = reinterpret_cast<const stbi_uc*>(content.data());
    const int size = static_cast<int>(content.size());
    int width = 0, height = 0, channels = 0;
    if (stbi_info_from_memory(bytes, size, &width, &height, &channels) == 0) {
        refuse_texture(file, "no header of either");
    }
    if (width < 1 || height < 1 || std::max(width, height) > static_cast<int>(most_texture_side)) {
        throw InputError(file, "size", fmt::format("{} x {} texels", width, height),
                         fmt::format("1 x 1 to {0} x {0}", most_texture_side));
    }
    if (ends_early(content)) {
        refuse_texture(file, "a file that ends early");
    }
    if (meaning == TexelMeaning::normal && channels < 3) {
        throw InputError(file, "content", "a grey image", "normals, as red, green and blue");
    }
    TextureImage image{static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height), {}};
    if (stbi_is_16_bit_from_memory(bytes, size) != 0) {
        const std::unique_ptr<stbi_us, FreePixels> pixels(
            stbi_load_16_from_memory(bytes, size, &width, &height, &channels, 3));
        if (pixels != nullptr) {
            image.texels = linear_texels(pixels.get(), image.width, image.height, meaning);
        }
    } else {
        const std::unique_ptr<stbi_uc, FreePixels> pixels(
            stbi_load_from_memory(bytes, size, &width, &height, &channels, 3));
        if (pixels != nullptr) {
            image.texels = linear_texels(pixels.get(), image.width, image.height, meaning);
        }
    }
    if (image.texels.empty()) {
        refuse_texture(file, fmt::format("what stb_image cannot read ({})", stbi_failure_reason()));
    }
    return image;
}

bool texture_has_alpha(std::string_view content) {
    int width = 0, height = 0, channels = 0;
    return stbi_info_from_memory(reinterpret_cast<const stbi_uc*>(content.data()), static_cast<int>(content.size()),
                                 &width, &height, &channels) != 0 &&
           (channels == 2 || channels == 4);
}

TextureImage read_texture_image(const std::filesystem::path& path, TexelMeaning meaning) {
    ImagesAtHand& images = images_at_hand();
    if (!images.is_alive) {
        return read_image_file(path, meaning);
    }
    const std::pair key{path.string(), meaning};
    const auto known = images.read.find(key);
    return known != images.read.end() ? known->second
                                      : images.read.emplace(key, read_image_file(path, meaning)).first->second;
}

}  // namespace pt
