// `render --out FILE.exr --aovs ..`: what stands in the file, what it leaves as it was, and calls that are wrong; and
// the encoder, read back through the library, bit by bit.
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "harness/exr.h"
#include "tests/support/command.h"
#if defined(PTBENCH_HAS_OPENEXR)
#include "tests/support/read_exr.h"
#endif

namespace pt::test {
namespace {

using nlohmann::json;
using Arguments = std::vector<std::string>;

CommandResult render_to(const std::string& file, const Arguments& added) {
    Arguments arguments{"render", "--scene", "cornell_open", "--resolution", "13x7", "--backend", "cpu", "--out", file};
    arguments.insert(arguments.end(), added.begin(), added.end());
    return ptbench(arguments);
}

void expect_refused(const std::string& name, const Arguments& added, const std::string& message) {
    const TemporaryFolder folder;
    const CommandResult result = render_to(folder.file(name), added);
    EXPECT_EQ(result.exit_code, 2) << name;
    EXPECT_EQ(result.out, "");
    EXPECT_NE(result.err.find(message), std::string::npos) << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_EQ(folder.content(), Arguments());
}

#if defined(PTBENCH_HAS_OPENEXR)

struct RenderedExr {
    json summary;
    ReadExr image;
};

RenderedExr render_exr(const Arguments& added) {
    const TemporaryFolder folder;
    const CommandResult result = render_to(folder.file("image.exr"), added);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.err, "");
    EXPECT_EQ(folder.content(), Arguments{"image.exr"});
    return {json::parse(result.out), read_exr(folder.file("image.exr"))};
}

// Rows of a .pfm go from the bottom to the top.
std::vector<float> channel_of_pfm(const std::string& content, std::size_t width, std::size_t height,
                                  std::size_t channel) {
    const std::size_t begin = content.size() - 12 * width * height;
    std::vector<float> values;
    for (std::size_t y = 0; y < height; ++y) {
        for (std::size_t x = 0; x < width; ++x) {
            float value = 0;
            std::memcpy(&value, content.data() + begin + 4 * (3 * ((height - 1 - y) * width + x) + channel), 4);
            values.push_back(value);
        }
    }
    return values;
}

TEST(ExrTest, FloatsReadBackBitForBit) {
    using Limits = std::numeric_limits<float>;
    const std::vector<float> values{0.0f,
                                    -0.0f,
                                    1.0f / 3,
                                    -2.5f,
                                    Limits::denorm_min(),
                                    Limits::min(),
                                    Limits::max(),
                                    Limits::lowest(),
                                    Limits::infinity(),
                                    -Limits::infinity(),
                                    Limits::quiet_NaN(),
                                    65505.0f};
    const TemporaryFolder folder;
    const std::string content = encode_exr({{"", "RGB", {values.begin(), values.end()}}, {"depth", "Z", {4, 3, 2, 1}}},
                                           2, 2, {{"ptbench.scene", "a room"}});
    write_text(folder.file("values.exr"), content);
    const ReadExr image = read_exr(folder.file("values.exr"));
    EXPECT_EQ(image.width, 2);
    EXPECT_EQ(image.height, 2);
    EXPECT_EQ(image.texts.at("ptbench.scene"), "a room");
    EXPECT_EQ(image.channels.at("depth.Z"), (std::vector<float>{4, 3, 2, 1}));
    EXPECT_EQ(image.channels.size(), 4u);
    for (std::size_t i = 0; i < values.size(); ++i) {
        const float read = image.channels.at(std::string(1, "RGB"[i % 3]))[i / 3];
        EXPECT_EQ(std::bit_cast<std::uint32_t>(read), std::bit_cast<std::uint32_t>(values[i])) << i;
    }
    EXPECT_EQ(encode_exr({{"", "RGB", values}, {"depth", "Z", {4, 3, 2, 1}}}, 2, 2, {{"ptbench.scene", "a room"}}),
              content);
    EXPECT_THROW(encode_exr({{"", "RGB", values}}, 2, 3), std::logic_error);
}

TEST(RenderExrTest, ItsColourIsThatOfAPfm) {
    const TemporaryFolder folder;
    const json summary = json::parse(render_to(folder.file("image.pfm"), {"--spp", "3"}).out);
    const std::string pfm = content_of(folder.file("image.pfm"));
    const RenderedExr plain = render_exr({"--spp", "3"});
    const RenderedExr full = render_exr({"--spp", "3", "--aovs", "all"});
    for (const RenderedExr& rendered : {plain, full}) {
        EXPECT_EQ(rendered.summary.at("film_hash"), summary.at("film_hash"));
        EXPECT_EQ(rendered.summary.at("rays"), summary.at("rays"));
        for (std::size_t i = 0; i < 3; ++i) {
            EXPECT_EQ(rendered.image.channels.at(std::string(1, "RGB"[i])), channel_of_pfm(pfm, 13, 7, i));
        }
        EXPECT_EQ(rendered.image.texts.at("ptbench.scene"), "cornell_open");
        EXPECT_EQ(rendered.image.texts.at("ptbench.film_hash"), summary.at("film_hash"));
        EXPECT_EQ(rendered.image.texts.at("ptbench.spp"), "3");
    }
    EXPECT_EQ(plain.image.channels.size(), 3u);
    EXPECT_FALSE(plain.summary.contains("aovs"));
    EXPECT_FALSE(summary.contains("aovs"));
}

TEST(RenderExrTest, LayersGoByTheNamesThatReadersGroup) {
    const RenderedExr rendered = render_exr({"--spp", "5", "--aovs", "all"});
    Arguments names;
    for (const auto& [name, values] : rendered.image.channels) {
        names.push_back(name);
        EXPECT_EQ(values.size(), 13u * 7u) << name;
        EXPECT_TRUE(std::all_of(values.begin(), values.end(), [](float value) { return std::isfinite(value); }))
            << name;
    }
    EXPECT_EQ(names, (Arguments{"B", "G", "R", "albedo.B", "albedo.G", "albedo.R", "coverage.Y", "depth.Z", "normal.X",
                                "normal.Y", "normal.Z", "samples.Y", "variance.B", "variance.G", "variance.R"}));
    EXPECT_EQ(rendered.image.channels.at("samples.Y"), std::vector<float>(13 * 7, 5.0f));
    const json& facts = rendered.summary.at("aovs");
    EXPECT_EQ(facts.at("names"), json({"albedo", "normal", "depth", "coverage", "samples", "variance"}));
    EXPECT_EQ(facts.at("camera_rays"), 5);
    EXPECT_EQ(facts.at("variance_batches"), 5);
    EXPECT_EQ(facts.at("variance_unbiased"), true);
}

TEST(RenderExrTest, OnlyWhatIsAskedFor) {
    const RenderedExr rendered = render_exr({"--spp", "1", "--aovs", "depth,samples"});
    EXPECT_EQ(rendered.image.channels.size(), 5u);
    EXPECT_TRUE(rendered.image.channels.contains("depth.Z"));
    EXPECT_FALSE(rendered.summary.at("aovs").contains("variance_batches"));
    EXPECT_FALSE(render_exr({"--aovs", "samples,variance"}).summary.at("aovs").contains("camera_rays"));
}

TEST(RenderExrTest, SaysWhereTheVarianceIsNotUnbiased) {
    const auto is_unbiased = [](const std::string& axis) {
        return render_exr({"--aovs", "variance", "--axis", axis}).summary.at("aovs").at("variance_unbiased");
    };
    EXPECT_EQ(is_unbiased("sampler=philox"), true);
    EXPECT_EQ(is_unbiased("sampler=sobol_owen"), false);
    EXPECT_EQ(is_unbiased("first_bounce=cached_jitters"), false);
}

TEST(RenderExrTest, StopsForTheVarianceLeaveEveryFilmAsItIs) {
    const std::vector<Arguments> variants{
        {"integrator=wavefront"},
        {"integrator=wavefront", "direct_light=nee_mis", "sampler=pmj02"},
        {"integrator=depth_first", "first_bounce=cached_jitters"},
        {"integrator=depth_first", "specialisation=generic", "precision=double"},
    };
    for (const Arguments& axes : variants) {
        Arguments call{"--spp", "20"};
        for (const std::string& axis : axes) {
            call.insert(call.end(), {"--axis", axis});
        }
        const TemporaryFolder folder;
        const CommandResult plain = render_to(folder.file("image.pfm"), call);
        ASSERT_EQ(plain.exit_code, 0) << plain.err;
        call.insert(call.end(), {"--aovs", "all"});
        EXPECT_EQ(render_exr(call).summary.at("film_hash"), json::parse(plain.out).at("film_hash")) << axes.back();
    }
}

TEST(RenderExrTest, CallsThatAreWrong) {
    const std::string allowed = "allowed: albedo, normal, depth, coverage, samples, variance, or all\n";
    expect_refused("image.exr", {"--aovs", "depht"}, "--aovs: argument: found \"depht\", " + allowed);
    expect_refused("image.exr", {"--aovs", "depth,"}, "--aovs: ");
    expect_refused("image.exr", {"--aovs", ""}, "--aovs: ");
    expect_refused("image.exr", {"--aovs", "depth,depth"}, "--aovs: ");
    expect_refused("image.png", {"--aovs", "depth"}, "a name that ends in .exr");
    expect_refused("image.exr", {"--aovs", "all", "--spp", "1"},
                   "--aovs: argument: found variance with --spp 1, allowed: --spp 2 or more");
    expect_refused("image.exr", {"--aovs", "all", "--axis", "integrator=depth_first", "--axis", "robustness=naive"},
                   "--aovs: argument: found variance of depth_first robustness=naive, allowed: a variant whose film ");
    expect_refused("image.exr",
                   {"--aovs", "depth", "--axis", "sampler=minstd_by_position", "--axis", "integrator=wavefront"},
                   "minstd_by_position");
}

#else

TEST(RenderExrTest, WithoutTheLibraryOneLineSaysSo) {
    EXPECT_FALSE(has_openexr());
    expect_refused("image.exr", {"--spp", "1"}, "this ptbench was built without OpenEXR (libopenexr-dev)\n");
}

#endif

}  // namespace
}  // namespace pt::test
