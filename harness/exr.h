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
    std::string channels;       // a letter each
    std::vector<float> values;  // row-major from the top, a pixel's channels together
};

// Whether this program was built with the library.
bool has_openexr();

// The file's content. `texts`: attributes of its header, by name. The same for the same input, whatever the time or the
// machine. Throws std::logic_error if a layer has another size, and where there is no library.
std::string encode_exr(const std::vector<ExrLayer>& layers, std::uint32_t width, std::uint32_t height,
                       const std::vector<std::pair<std::string, std::string>>& texts = {});

struct ExrSize {
    long long width = 0, height = 0;
};
// The display window, which is the image that a file means, and the data window, which has its pixels.
struct ExrWindows {
    ExrSize display, data;
};
// The size of an EXR file's windows. Throws InputError for what is no image that can be read, in the name of `file`,
// and std::logic_error where there is no library.
ExrWindows exr_windows(std::string_view content, const std::string& file);
// The image in the display window, row-major from the top, from channels R, G and B, or Y three times. Throws
// InputError, too, where these numbers are not linear light of sRGB's primaries for each pixel of an equirectangular
// image: a data window that lacks pixels, luminance with chroma, a cube map, other primaries.
std::vector<float> decode_exr(std::string_view content, const std::string& file);

}  // namespace pt
