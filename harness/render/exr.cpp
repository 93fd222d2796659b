#include "harness/render/exr.h"

#include <algorithm>
#include <cstring>
#include <stdexcept>

#include <fmt/format.h>

#include "harness/error.h"

#if defined(PTBENCH_HAS_OPENEXR)
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfStringAttribute.h>
#endif

namespace pt {

#if defined(PTBENCH_HAS_OPENEXR)

namespace {

// The library goes back to fill in the table of where lines begin.
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

// What the library throws, as the project says it.
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

std::string colour_channel(const Imf::InputFile& file, const std::string& name, std::size_t i) {
    const Imf::ChannelList& channels = file.header().channels();
    const std::string wanted = channels.findChannel("Y") != nullptr ? "Y" : std::string(1, "RGB"[i]);
    const Imf::Channel* const channel = channels.findChannel(wanted);
    if (channel == nullptr || channel->xSampling != 1 || channel->ySampling != 1) {
        throw InputError(name, "channels", fmt::format("no {} of every pixel", wanted), "R, G and B, or Y");
    }
    return wanted;
}

}  // namespace

bool has_openexr() { return true; }

ExrSize exr_size(std::string_view content, const std::string& file) {
    return read_exr_file(content, file, [](const Imf::InputFile& image) {
        const Imath::Box2i& window = image.header().dataWindow();
        return ExrSize{1LL + window.max.x - window.min.x, 1LL + window.max.y - window.min.y};
    });
}

std::vector<float> decode_exr(std::string_view content, const std::string& file) {
    return read_exr_file(content, file, [&](Imf::InputFile& image) {
        const Imath::Box2i window = image.header().dataWindow();
        const auto width = static_cast<std::size_t>(1LL + window.max.x - window.min.x);
        const auto height = static_cast<std::size_t>(1LL + window.max.y - window.min.y);
        std::vector<float> values(3 * width * height);
        Imf::FrameBuffer frame;
        const bool is_grey = image.header().channels().findChannel("Y") != nullptr;
        for (std::size_t i = 0; i < (is_grey ? 1 : 3); ++i) {
            const std::string channel = colour_channel(image, file, i);
            frame.insert(channel, Imf::Slice::Make(Imf::FLOAT, values.data() + i, window, 3 * sizeof(float),
                                                   3 * sizeof(float) * width));
        }
        image.setFrameBuffer(frame);
        image.readPixels(window.min.y, window.max.y);
        for (std::size_t i = 0; is_grey && i < values.size(); i += 3) {
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
            // The library's type is that of a buffer to read into as well; writing leaves it as it is.
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
    }  // its end writes the table
    return text;
}

#else

bool has_openexr() { return false; }

std::string encode_exr(const std::vector<ExrLayer>&, std::uint32_t, std::uint32_t,
                       const std::vector<std::pair<std::string, std::string>>&) {
    throw std::logic_error("built without OpenEXR");
}

ExrSize exr_size(std::string_view, const std::string&) { throw std::logic_error("built without OpenEXR"); }

std::vector<float> decode_exr(std::string_view, const std::string&) { throw std::logic_error("built without OpenEXR"); }

#endif

}  // namespace pt
