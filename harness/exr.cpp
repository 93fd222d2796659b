#include "harness/exr.h"

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <tuple>

#include <fmt/format.h>

#include "harness/failure.h"

#if defined(PTBENCH_HAS_OPENEXR)
#include <ImfChannelList.h>
#include <ImfEnvmap.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#endif

namespace pt {

#if defined(PTBENCH_HAS_OPENEXR)

namespace {

// A stream that writes to a string. OpenEXR seeks back in it to fill in the table of line offsets.
class ExrText : public Imf::OStream {
public:
    explicit ExrText(std::string& text) : Imf::OStream("the image"), text_(text) {}
    void write(const char* bytes, int count) override {
        const auto size = static_cast<std::size_t>(count);
        text_.resize(std::max(text_.size(), place_ + size));
        std::copy_n(bytes, size, text_.begin() + static_cast<std::ptrdiff_t>(place_));
        place_ += size;
    }
    std::uint64_t tellp() override { return place_; }
    void seekp(std::uint64_t place) override { place_ = place; }

private:
    std::string& text_;
    std::size_t place_ = 0;
};

class ExrContent : public Imf::IStream {
public:
    ExrContent(std::string_view content, const std::string& file) : Imf::IStream(file.c_str()), content_(content) {}
    bool read(char bytes[], int count) override {
        const auto size = static_cast<std::size_t>(count);
        if (place_ > content_.size() || size > content_.size() - place_) {
            throw std::runtime_error("it ends early");
        }
        std::memcpy(bytes, content_.data() + place_, size);
        place_ += size;
        return place_ < content_.size();
    }
    std::uint64_t tellg() override { return place_; }
    void seekg(std::uint64_t place) override { place_ = place; }

private:
    std::string_view content_;
    std::size_t place_ = 0;
};

// Calls `read` on an EXR file and turns the exceptions of the OpenEXR library into InputError.
template <class Read>
auto read_exr_file(std::string_view content, const std::string& name, const Read& read) {
    try {
        ExrContent stream(content, name);
        Imf::InputFile file(stream, 0);
        return read(file);
    } catch (const InputError&) {
        throw;
    } catch (const std::exception& error) {
        throw InputError(name, "content", fmt::format("no OpenEXR image that can be read ({})", error.what()),
                         "an image of OpenEXR 2 or 3, in lines or tiles");
    }
}

bool has_channel(const Imf::Header& header, const std::string& name) {
    return header.channels().findChannel(name) != nullptr;
}

// Returns the names of the channels that hold the image: R, G and B, or Y (luminance) alone.
std::vector<std::string> colour_channels(const Imf::Header& header, const std::string& name) {
    const std::vector<std::string> colours{"R", "G", "B"};
    const bool is_coloured =
        std::all_of(colours.begin(), colours.end(), [&](const auto& one) { return has_channel(header, one); });
    if (!is_coloured && has_channel(header, "Y") && (has_channel(header, "RY") || has_channel(header, "BY"))) {
        throw InputError(name, "channels", "luminance and chroma (Y, RY and BY)", "R, G and B, or Y alone");
    }
    const std::vector<std::string> wanted =
        !is_coloured && has_channel(header, "Y") ? std::vector<std::string>{"Y"} : colours;
    for (const std::string& one : wanted) {
        const Imf::Channel* const channel = header.channels().findChannel(one);
        if (channel == nullptr || channel->xSampling != 1 || channel->ySampling != 1) {
            throw InputError(name, "channels", fmt::format("no {} of every pixel", one), "R, G and B, or Y");
        }
    }
    return wanted;
}

std::string in_words(const Imath::Box2i& window) {
    return fmt::format("{}, {} to {}, {}", window.min.x, window.min.y, window.max.x, window.max.y);
}

void check_windows(const Imf::Header& header, const std::string& name) {
    const Imath::Box2i &data = header.dataWindow(), &display = header.displayWindow();
    const bool covers = data.min.x <= display.min.x && data.min.y <= display.min.y && data.max.x >= display.max.x &&
                        data.max.y >= display.max.y;
    // An environment map's data window must equal its display window: OpenEXR spreads it over all directions.
    if (!covers || (Imf::hasEnvmap(header) && data != display)) {
        throw InputError(
            name, "windows",
            fmt::format("a data window from {} in a display window from {}", in_words(data), in_words(display)),
            "pixels for the whole display window");
    }
}

void check_primaries(const Imf::Header& header, const std::string& name) {
    if (!Imf::hasChromaticities(header)) {
        return;
    }
    constexpr float slight = 2e-3f;
    const Imf::Chromaticities is = Imf::chromaticities(header), srgb;
    for (const auto& [found, wanted, what] :
         {std::tuple(is.red, srgb.red, "red"), std::tuple(is.green, srgb.green, "green"),
          std::tuple(is.blue, srgb.blue, "blue"), std::tuple(is.white, srgb.white, "white")}) {
        if (!((found - wanted).length() < slight)) {
            throw InputError(name, "chromaticities", fmt::format("{} at {}, {}", what, found.x, found.y),
                             fmt::format("{}, {}, as sRGB has it", wanted.x, wanted.y));
        }
    }
}

void check_meaning(const Imf::Header& header, const std::string& name) {
    if (Imf::hasEnvmap(header) && Imf::envmap(header) != Imf::ENVMAP_LATLONG) {
        const int type = Imf::envmap(header);
        throw InputError(name, "envmap", type == Imf::ENVMAP_CUBE ? "cube" : fmt::format("{}", type),
                         "latlong, or none: an equirectangular image");
    }
    check_windows(header, name);
    check_primaries(header, name);
}

ExrSize size_of(const Imath::Box2i& window) {
    return {1LL + window.max.x - window.min.x, 1LL + window.max.y - window.min.y};
}

// Reads one channel of the rows of the display window; each row is as wide as the data window.
std::vector<float> read_channel(Imf::InputFile& image, const std::string& channel) {
    const Imath::Box2i &data = image.header().dataWindow(), &display = image.header().displayWindow();
    const Imath::Box2i rows({data.min.x, display.min.y}, {data.max.x, display.max.y});
    const auto width = static_cast<std::size_t>(size_of(rows).width);
    std::vector<float> values(width * static_cast<std::size_t>(size_of(rows).height));
    Imf::FrameBuffer frame;
    frame.insert(channel, Imf::Slice::Make(Imf::FLOAT, values.data(), rows, sizeof(float), sizeof(float) * width));
    image.setFrameBuffer(frame);
    image.readPixels(display.min.y, display.max.y);
    return values;
}

}  // namespace

bool has_openexr() { return true; }

ExrWindows exr_windows(std::string_view content, const std::string& file) {
    return read_exr_file(content, file, [](const Imf::InputFile& image) {
        return ExrWindows{size_of(image.header().displayWindow()), size_of(image.header().dataWindow())};
    });
}

std::vector<float> decode_exr(std::string_view content, const std::string& file) {
    return read_exr_file(content, file, [&](Imf::InputFile& image) {
        check_meaning(image.header(), file);
        const std::vector<std::string> channels = colour_channels(image.header(), file);
        const Imath::Box2i &data = image.header().dataWindow(), &display = image.header().displayWindow();
        const auto width = static_cast<std::size_t>(size_of(display).width);
        const auto height = static_cast<std::size_t>(size_of(display).height);
        const auto row = static_cast<std::size_t>(size_of(data).width);
        const auto left = static_cast<std::size_t>(display.min.x - data.min.x);
        std::vector<float> values(3 * width * height);
        for (std::size_t i = 0; i < channels.size(); ++i) {
            const std::vector<float> channel = read_channel(image, channels[i]);
            for (std::size_t pixel = 0; pixel < width * height; ++pixel) {
                values[3 * pixel + i] = channel[pixel / width * row + left + pixel % width];
            }
        }
        for (std::size_t i = 0; channels.size() == 1 && i < values.size(); i += 3) {
            values[i + 1] = values[i + 2] = values[i];
        }
        return values;
    });
}

std::string encode_exr(const std::vector<ExrLayer>& layers, std::uint32_t width, std::uint32_t height,
                       const std::vector<std::pair<std::string, std::string>>& texts) {
    Imf::Header header(static_cast<int>(width), static_cast<int>(height));
    header.compression() = Imf::ZIP_COMPRESSION;
    for (const auto& [name, text] : texts) {
        header.insert(name, Imf::StringAttribute(text));
    }
    Imf::FrameBuffer frame;
    for (const ExrLayer& layer : layers) {
        const std::size_t count = layer.channels.size();
        if (layer.values.size() != count * width * height) {
            throw std::logic_error("a layer of another size than the image");
        }
        for (std::size_t i = 0; i < count; ++i) {
            const std::string channel = (layer.name.empty() ? "" : layer.name + ".") + layer.channels[i];
            header.channels().insert(channel, Imf::Channel(Imf::FLOAT));
            // `Slice` takes a mutable pointer for reading files; writing a file leaves the data unchanged.
            char* const first = reinterpret_cast<char*>(const_cast<float*>(layer.values.data() + i));
            frame.insert(channel, Imf::Slice(Imf::FLOAT, first, count * sizeof(float), count * width * sizeof(float)));
        }
    }
    std::string text;
    ExrText stream(text);
    {
        Imf::OutputFile file(stream, header, 0);
        file.setFrameBuffer(frame);
        file.writePixels(static_cast<int>(height));
    }  // the destructor of `file` writes the EXR table of line offsets
    return text;
}

#else

bool has_openexr() { return false; }

std::string encode_exr(const std::vector<ExrLayer>&, std::uint32_t, std::uint32_t,
                       const std::vector<std::pair<std::string, std::string>>&) {
    throw std::logic_error("built without OpenEXR");
}

ExrWindows exr_windows(std::string_view, const std::string&) { throw std::logic_error("built without OpenEXR"); }

std::vector<float> decode_exr(std::string_view, const std::string&) { throw std::logic_error("built without OpenEXR"); }

#endif

}  // namespace pt
