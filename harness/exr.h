// OpenEXR images of several layers: channels of 32-bit floats under the names that readers group them by
// (https://openexr.com/en/latest/TechnicalIntroduction.html#layers), without loss, through the OpenEXR 3 library.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace pt {

// A layer of an EXR file: channels "name.R", "name.G", .. or, if it has no name, "R", "G", ..
struct ExrLayer {
    std::string name;
    std::string channels;       // names of the layer's channels, one letter each
    std::vector<float> values;  // pixel values, row-major from the top, a pixel's channels adjacent
};

// Whether this build has the OpenEXR library.
bool has_openexr();

// Encodes the layers as the content of an EXR file. `texts`: attributes of its header, by name. The bytes depend on the
// input alone, not on the time or the machine. Throws std::logic_error if a layer has another size than the image, and
// where the program was built without OpenEXR.
std::string encode_exr(const std::vector<ExrLayer>& layers, std::uint32_t width, std::uint32_t height,
                       const std::vector<std::pair<std::string, std::string>>& texts = {});

struct ExrSize {
    long long width = 0, height = 0;
};
// The display window of an EXR file, which is the image that it means, and its data window, which has its pixels.
struct ExrWindows {
    ExrSize display, data;
};
// Returns the size of an EXR file's windows. Throws InputError, naming `file`, for content that is no readable EXR
// image, and std::logic_error where the program was built without OpenEXR.
ExrWindows exr_windows(std::string_view content, const std::string& file);
// Decodes the display window of an EXR file, row-major from the top, from channels R, G and B, or Y three times. Throws
// InputError for what `exr_windows` refuses and for images that are no complete equirectangular map in linear sRGB: a
// data window that lacks pixels, luminance with chroma, a cube map, other primaries.
std::vector<float> decode_exr(std::string_view content, const std::string& file);

}  // namespace pt
