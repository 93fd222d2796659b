// What the header of an OpenEXR image says of its pixels: read as it says, or refused. The images are the library's
// own.
#include <gtest/gtest.h>

#include "harness/failure.h"
#include "harness/scene/environment_image.h"
#include "tests/support/command.h"

#if defined(PTBENCH_HAS_OPENEXR)

#include <ImfChannelList.h>
#include <ImfEnvmap.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfRgbaFile.h>
#include <ImfStandardAttributes.h>

namespace pt::test {
namespace {

const Imath::Box2i whole({0, 0}, {3, 1});

// Pixel x, y of every channel is 1 + x + 10 y and a hundred times the channel's place in `channels`, all at least 0.
std::string exr_of(const Imf::Header& header, const std::vector<std::string>& channels) {
    const TemporaryFolder folder;
    const Imath::Box2i window = header.dataWindow();
    const auto width = static_cast<std::size_t>(window.max.x - window.min.x + 1);
    const auto height = static_cast<std::size_t>(window.max.y - window.min.y + 1);
    Imf::Header with_channels = header;
    Imf::FrameBuffer frame;
    std::vector<std::vector<float>> values;
    for (std::size_t i = 0; i < channels.size(); ++i) {
        with_channels.channels().insert(channels[i], Imf::Channel(Imf::FLOAT));
        std::vector<float>& of_channel = values.emplace_back();
        for (int y = window.min.y; y <= window.max.y; ++y) {
            for (int x = window.min.x; x <= window.max.x; ++x) {
                of_channel.push_back(static_cast<float>(1 + x + 10 * y + 100 * static_cast<int>(i)));
            }
        }
    }
    for (std::size_t i = 0; i < channels.size(); ++i) {
        frame.insert(channels[i],
                     Imf::Slice::Make(Imf::FLOAT, values[i].data(), window, sizeof(float), sizeof(float) * width));
    }
    {
        Imf::OutputFile file(folder.file("a.exr").c_str(), with_channels);
        file.setFrameBuffer(frame);
        file.writePixels(static_cast<int>(height));
    }
    return content_of(folder.file("a.exr"));
}

std::string refusal(const std::string& content) {
    try {
        (void)parse_exr(content, "sky.exr");
    } catch (const InputError& error) {
        return error.what();
    }
    return "read";
}

const std::vector<std::string> rgb{"R", "G", "B"};

TEST(EnvironmentExrTest, ADataWindowBeyondTheDisplayWindowIsCut) {
    for (const Imath::Box2i& data : {whole, Imath::Box2i({-2, 0}, {4, 2}), Imath::Box2i({0, -1}, {3, 1})}) {
        Imf::Header header(whole, data);
        if (data.min.y < 0) {
            header.lineOrder() = Imf::DECREASING_Y;
        }
        const EnvironmentImage image = parse_exr(exr_of(header, rgb), "sky.exr");
        ASSERT_EQ(image.width, 4u);
        ASSERT_EQ(image.height, 2u);
        for (std::uint32_t y = 0; y < 2; ++y) {
            for (std::uint32_t x = 0; x < 4; ++x) {
                const float red = 1.0f + static_cast<float>(x) + 10 * static_cast<float>(y);
                EXPECT_EQ(image.texels[y * 4 + x], Vec3<float>(red, red + 100, red + 200)) << x << ", " << y;
            }
        }
    }
    // Data window and display window may both begin elsewhere than at (0, 0).
    const Imath::Box2i shifted({5, 7}, {8, 8});
    EXPECT_EQ(parse_exr(exr_of(Imf::Header(shifted, shifted), {"Y"}), "sky.exr").texels[4], Vec3<float>(86));
}

TEST(EnvironmentExrTest, ADataWindowThatLacksPixelsIsRefused) {
    EXPECT_EQ(refusal(exr_of(Imf::Header(whole, Imath::Box2i({1, 0}, {2, 1})), rgb)),
              "sky.exr: windows: found a data window from 1, 0 to 2, 1 in a display window from 0, 0 to 3, 1, allowed: "
              "pixels for the whole display window");
    EXPECT_NE(refusal(exr_of(Imf::Header(whole, Imath::Box2i({0, 0}, {3, 0})), rgb)), "read");
    EXPECT_NE(refusal(exr_of(Imf::Header(whole, Imath::Box2i({0, 5}, {3, 6})), rgb)), "read");
    EXPECT_EQ(refusal(exr_of(Imf::Header(whole, Imath::Box2i({0, 0}, {8192, 1})), rgb)),
              "sky.exr: size: found 8193 x 2 texels, allowed: 1 x 1 to 8192 x 4096");
}

TEST(EnvironmentExrTest, OnlyAMapOfLatitudeAndLongitudeIsAnEnvironment) {
    Imf::Header header(whole, whole);
    Imf::addEnvmap(header, Imf::ENVMAP_LATLONG);
    EXPECT_EQ(refusal(exr_of(header, rgb)), "read");
    Imf::envmapAttribute(header).value() = Imf::ENVMAP_CUBE;
    EXPECT_EQ(refusal(exr_of(header, rgb)),
              "sky.exr: envmap: found cube, allowed: latlong, or none: an equirectangular image");
    Imf::Header larger(whole, Imath::Box2i({-1, 0}, {4, 1}));
    Imf::addEnvmap(larger, Imf::ENVMAP_LATLONG);
    EXPECT_EQ(refusal(exr_of(larger, rgb)).find("sky.exr: windows: "), 0u);
}

TEST(EnvironmentExrTest, LuminanceIsGreyOnlyWhereItIsAlone) {
    EXPECT_EQ(parse_exr(exr_of(Imf::Header(whole, whole), {"Y"}), "").texels[1], Vec3<float>(2));
    EXPECT_EQ(parse_exr(exr_of(Imf::Header(whole, whole), {"B", "G", "R", "Y"}), "").texels[1],
              Vec3<float>(202, 102, 2));
    const std::string chroma =
        "sky.exr: channels: found luminance and chroma (Y, RY and BY), allowed: R, G and B, or Y alone";
    EXPECT_EQ(refusal(exr_of(Imf::Header(whole, whole), {"Y", "RY", "BY"})), chroma);
    const TemporaryFolder folder;
    const std::vector<Imf::Rgba> red(8, Imf::Rgba(1, 0, 0));
    {
        Imf::RgbaOutputFile file(folder.file("a.exr").c_str(), Imf::Header(4, 2), Imf::WRITE_YC);
        file.setFrameBuffer(red.data(), 1, 4);
        file.writePixels(2);
    }
    EXPECT_EQ(refusal(content_of(folder.file("a.exr"))), chroma);
}

TEST(EnvironmentExrTest, OtherPrimariesAreRefused) {
    Imf::Header header(whole, whole);
    Imf::addChromaticities(header, Imf::Chromaticities());
    EXPECT_EQ(refusal(exr_of(header, rgb)), "read");
    // ACES, AP0.
    Imf::chromaticitiesAttribute(header).value() =
        Imf::Chromaticities({0.7347f, 0.2653f}, {0.0f, 1.0f}, {0.0001f, -0.077f}, {0.32168f, 0.33767f});
    EXPECT_EQ(refusal(exr_of(header, rgb)),
              "sky.exr: chromaticities: found red at 0.7347, 0.2653, allowed: 0.64, 0.33, as sRGB has it");
}

}  // namespace
}  // namespace pt::test

#endif
