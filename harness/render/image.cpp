#include "harness/render/image.h"

#include <bit>
#include <cmath>
#include <cstring>
#include <filesystem>

#include <fmt/format.h>

#include "harness/exr.h"
#include "harness/failure.h"
#include "harness/write_file.h"

#define STB_IMAGE_WRITE_IMPLEMENTATION
#include <stb/stb_image_write.h>

namespace pt {

namespace {

// Converts a linear value to a byte of sRGB (IEC 61966-2-1).
unsigned char to_srgb8(double linear) {
    const double clipped = std::min(1.0, std::max(0.0, linear));
    const double encoded = clipped <= 0.0031308 ? 12.92 * clipped : 1.055 * std::pow(clipped, 1.0 / 2.4) - 0.055;
    return static_cast<unsigned char>(std::lround(255.0 * encoded));
}

std::string encode_png(const Film& film) {
    std::vector<unsigned char> bytes;
    bytes.reserve(std::size_t{3} * film.width() * film.height());
    for (const float value : film.radiance()) {
        bytes.push_back(to_srgb8(value));
    }
    std::string encoded;
    const auto append = [](void* context, void* data, int size) {
        static_cast<std::string*>(context)->append(static_cast<const char*>(data), static_cast<std::size_t>(size));
    };
    if (stbi_write_png_to_func(append, &encoded, static_cast<int>(film.width()), static_cast<int>(film.height()), 3,
                               bytes.data(), static_cast<int>(3 * film.width())) == 0) {
        throw MachineError("the PNG encoder failed");
    }
    return encoded;
}

// Encodes a .pfm file: rows from bottom to top; the negative scale means little-endian.
std::string encode_pfm(const std::vector<float>& values, std::uint32_t width, std::uint32_t height) {
    static_assert(std::endian::native == std::endian::little);
    std::string encoded = fmt::format("PF\n{} {}\n-1.0\n", width, height);
    const std::size_t row = std::size_t{3} * width;
    for (std::uint32_t y = height; y-- > 0;) {
        encoded.append(reinterpret_cast<const char*>(&values[y * row]), row * sizeof(float));
    }
    return encoded;
}

}  // namespace

void check_image_name(const std::string& file) {
    const std::string ending = std::filesystem::path(file).extension().string();
    if (ending == ".exr" && !has_openexr()) {
        throw InputError("--out", "file name", "\"" + file + "\"",
                         "a name that ends in .png or .pfm: this ptbench was built without OpenEXR (libopenexr-dev)");
    }
    if (ending != ".png" && ending != ".pfm" && ending != ".exr") {
        throw InputError("--out", "file name", "\"" + file + "\"",
                         has_openexr() ? "a name that ends in .png, .pfm or .exr" : "a name that ends in .png or .pfm");
    }
}

void write_image(const Film& film, const std::string& file) {
    check_image_name(file);
    const std::string ending = std::filesystem::path(file).extension().string();
    write_file(file, ending == ".png"   ? encode_png(film)
                     : ending == ".exr" ? encode_exr({{"", "RGB", film.radiance()}}, film.width(), film.height())
                                        : encode_pfm(film.radiance(), film.width(), film.height()));
}

void write_pfm(const std::vector<float>& radiance, std::uint32_t width, std::uint32_t height, const std::string& file) {
    write_file(file, encode_pfm(radiance, width, height));
}

}  // namespace pt
