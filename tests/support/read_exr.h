// Reads an OpenEXR image back through the library, whose reader shares nothing with ptbench's side of the writing.
#pragma once

#include <map>
#include <string>
#include <vector>

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfStringAttribute.h>

namespace pt::test {

struct ReadExr {
    int width = 0, height = 0;
    std::map<std::string, std::vector<float>> channels;  // row-major from the top
    std::map<std::string, std::string> texts;            // attributes
};

inline ReadExr read_exr(const std::string& name) {
    Imf::InputFile file(name.c_str());
    const Imf::Header& header = file.header();
    const Imath::Box2i window = header.dataWindow();
    ReadExr image{window.max.x - window.min.x + 1, window.max.y - window.min.y + 1, {}, {}};
    Imf::FrameBuffer frame;
    for (auto channel = header.channels().begin(); channel != header.channels().end(); ++channel) {
        if (channel.channel().type != Imf::FLOAT) {
            throw std::runtime_error(std::string(channel.name()) + " is no channel of floats");
        }
        std::vector<float>& values = image.channels[channel.name()];
        values.resize(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
        frame.insert(channel.name(), Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(values.data()), sizeof(float),
                                                sizeof(float) * static_cast<std::size_t>(image.width)));
    }
    file.setFrameBuffer(frame);
    file.readPixels(window.min.y, window.max.y);
    for (auto attribute = header.begin(); attribute != header.end(); ++attribute) {
        if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&attribute.attribute())) {
            image.texts[attribute.name()] = text->value();
        }
    }
    return image;
}

}  // namespace pt::test
