#include "harness/render/exr.h"

#include <algorithm>
#include <stdexcept>

#if defined(PTBENCH_HAS_OPENEXR)
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
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

}  // namespace

bool has_openexr() { return true; }

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

#endif

}  // namespace pt
