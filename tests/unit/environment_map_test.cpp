// Light from all round (kernels/environment_map.h): its density sums to 1, directions are drawn by it and looked up
// where they were drawn, texels lie where the documentation says; images are read, and broken ones refused.
#include <cmath>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "harness/exr.h"
#include "harness/failure.h"
#include "harness/scene/environment_table.h"
#include "tests/support/scenes.h"
#include "tests/support/statistics.h"

namespace pt {
namespace {

using test::chi_square_alpha;
using test::Random;
using test::SceneBuilder;

constexpr double whole_share = 0x1p32;

SceneEnvironment environment_with(std::uint32_t width, std::uint32_t height, const std::vector<Vec3d>& texels,
                                  double rotation = 0) {
    SceneBuilder builder;
    builder.environment_map(width, height, texels, rotation);
    return *builder.scene.environment_map;
}

// An environment of texels from 0 to 1, and one that is `bright`.
SceneEnvironment random_environment(std::uint32_t width, std::uint32_t height, double bright, double rotation = 0) {
    Random random(7);
    std::vector<Vec3d> texels;
    for (std::uint32_t i = 0; i < width * height; ++i) {
        texels.push_back({random.uniform(), random.uniform(), random.uniform()});
    }
    texels[width * height / 3] = Vec3d(bright);
    texels[1] = Vec3d(0.0);
    return environment_with(width, height, texels, rotation);
}

template <class Real>
double solid_angle_of_texel(const EnvironmentMap<Real>& map, std::uint32_t row) {
    const double bottom = row + 1 < map.rows.size ? static_cast<double>(map.rows[row + 1].top) : -1;
    return 2 * pi<double> * (static_cast<double>(map.rows[row].top) - bottom) / map.width;
}

template <class Real>
class EnvironmentMapTest : public testing::Test {};
using Reals = testing::Types<float, double>;
TYPED_TEST_SUITE(EnvironmentMapTest, Reals);

TYPED_TEST(EnvironmentMapTest, DensityIntegratesToOne) {
    for (const double bright : {1.0, 1e8, 1e30}) {
        const auto table = environment_table<TypeParam>(random_environment(37, 19, bright), 0, true);
        const EnvironmentMap<TypeParam>& map = table->map;
        double whole = 0, sphere = 0;
        for (std::uint32_t row = 0; row < map.rows.size; ++row) {
            for (std::uint32_t column = 0; column < map.width; ++column) {
                const TypeParam inverse_pdf = place_at(map, row, column).inverse_pdf;
                ASSERT_TRUE(inverse_pdf > 0 && std::isfinite(inverse_pdf)) << row << ", " << column;
                whole += solid_angle_of_texel(map, row) / static_cast<double>(inverse_pdf);
                sphere += solid_angle_of_texel(map, row);
            }
        }
        EXPECT_NEAR(sphere, 4 * pi<double>, 1e-12);
        EXPECT_NEAR(whole, 1, sizeof(TypeParam) == 4 ? 1e-6 : 1e-14) << bright;
    }
}

// Cells: quarters of texels, by solid angle.
TYPED_TEST(EnvironmentMapTest, DirectionsAreDrawnByTheDensity) {
    constexpr std::uint32_t width = 9, height = 7;
    const auto table = environment_table<TypeParam>(random_environment(width, height, 40, 77), 0, true);
    const EnvironmentMap<TypeParam>& map = table->map;
    std::vector<std::uint64_t> counts(4 * width * height);
    std::vector<double> probabilities(counts.size());
    for (std::uint32_t row = 0; row < height; ++row) {
        for (std::uint32_t column = 0; column < width; ++column) {
            const double pdf = 1 / static_cast<double>(place_at(map, row, column).inverse_pdf);
            for (std::size_t quarter = 0; quarter < 4; ++quarter) {
                probabilities[4 * (row * width + column) + quarter] = pdf * solid_angle_of_texel(map, row) / 4;
            }
        }
    }
    Random random(11);
    for (int i = 0; i < 400000; ++i) {
        const auto sample = sample_environment(map, random.word(), random.word(), random.word());
        const Vec3d d(sample.direction);
        ASSERT_NEAR(dot(d, d), 1, 1e-6);
        std::uint32_t row = 0;
        while (row + 1 < height && d.y <= static_cast<double>(map.rows[row + 1].top)) {
            ++row;
        }
        const double top = static_cast<double>(map.rows[row].top);
        const double bottom = row + 1 < height ? static_cast<double>(map.rows[row + 1].top) : -1;
        const double turns = std::atan2(d.x, -d.z) / (2 * pi<double>)+77.0 / 360;
        const double across = (turns - std::floor(turns)) * width;
        const auto column = std::min(width - 1, static_cast<std::uint32_t>(across));
        const std::size_t quarter = (2 * (top - d.y) > top - bottom ? 2u : 0u) + (across - column > 0.5 ? 1u : 0u);
        counts[4 * (row * width + column) + quarter] += 1;
    }
    EXPECT_GT(test::chi_square_test(counts, probabilities), chi_square_alpha);
}

TYPED_TEST(EnvironmentMapTest, OneTexelIsTheUniformSphere) {
    const auto table = environment_table<TypeParam>(environment_with(1, 1, {{1, 2, 3}}), 0, true);
    Random random(3);
    for (int i = 0; i < 100; ++i) {
        const auto sample = sample_environment(table->map, random.word(), random.word(), random.word());
        EXPECT_EQ(sample.place.inverse_pdf, static_cast<TypeParam>(4 * pi<double>));
        EXPECT_EQ(sample.place.radiance, Vec3<TypeParam>(1, 2, 3));
    }
}

// A texel of probability 2^-32 in its row: its middle is not all that is drawn.
TYPED_TEST(EnvironmentMapTest, WithinAShareOfOneWordDirectionsAreSpread) {
    const EnvironmentTexel<TypeParam> entry{Vec3<TypeParam>(TypeParam(1)), 5};
    EXPECT_LT(place_in_entry<TypeParam>(entry, TypeParam(1), 5, 0), TypeParam(0.001));
    EXPECT_GT(place_in_entry<TypeParam>(entry, TypeParam(1), 5, 0xffff), TypeParam(0.999));
    EXPECT_LE(place_in_entry<TypeParam>(entry, TypeParam(1), 5, 0xffff), TypeParam(1));
}

TYPED_TEST(EnvironmentMapTest, IsLookedUpWhereItWasDrawn) {
    for (const double rotation : {0.0, 30.0, -200.0}) {
        const auto table = environment_table<TypeParam>(random_environment(64, 32, 1e8, rotation), 0, true);
        const EnvironmentMap<TypeParam>& map = table->map;
        Random random(5);
        int elsewhere = 0;
        for (int i = 0; i < 20000; ++i) {
            // Every texel as often: by the bright one alone nothing would be tested.
            const auto row = static_cast<std::uint32_t>(random.uniform() * 32);
            const auto column = static_cast<std::uint32_t>(random.uniform() * 64);
            const auto word_in = [&](const auto* entries, std::uint32_t count, std::uint32_t entry) {
                const double share = static_cast<double>(share_of_entry<TypeParam>(entries, count, entry));
                return entries[entry].first + static_cast<std::uint32_t>(random.uniform() * (share - 1));
            };
            const auto sample = sample_environment(map, word_in(map.rows.data, 32, row),
                                                   word_in(map.texels.data + row * 64, 64, column), random.word());
            const auto found = environment_towards(map, sample.direction);
            EXPECT_EQ(sample.place.inverse_pdf, place_at(map, row, column).inverse_pdf);
            elsewhere += found.radiance != sample.place.radiance || found.inverse_pdf != sample.place.inverse_pdf;
        }
        // In its texel but for those that rounding takes over the border.
        EXPECT_LT(elsewhere, 5) << rotation;
    }
}

TYPED_TEST(EnvironmentMapTest, TexelsLieWhereTheDocumentationSays) {
    using V = Vec3<TypeParam>;
    const std::vector<Vec3d> texels{Vec3d(1), Vec3d(2), Vec3d(3), Vec3d(4), Vec3d(5), Vec3d(6), Vec3d(7), Vec3d(8)};
    const auto along = [&](double rotation, const V& direction) {
        const auto table = environment_table<TypeParam>(environment_with(4, 2, texels, rotation), 0, true);
        return environment_towards(table->map, normalize(direction)).radiance.x;
    };
    // Quarters of a turn from -z by way of +x; the upper row first.
    EXPECT_EQ(along(0, V(0.1, 1, -1)), 1);
    EXPECT_EQ(along(0, V(1, 1, 0.1)), 2);
    EXPECT_EQ(along(0, V(-0.1, 1, 1)), 3);
    EXPECT_EQ(along(0, V(-1, 1, -0.1)), 4);
    EXPECT_EQ(along(0, V(0.1, -1, -1)), 5);
    EXPECT_EQ(along(0, V(-1, -1, -0.1)), 8);
    // Turned as an object is: what was seen along a direction is seen along the turned one.
    for (const double degrees : {90.0, 40.0, -100.0, 725.0}) {
        const Rotation turn = rotation_of({0, degrees, 0});
        for (const V& d : {V(0.1, 1, -1), V(1, -1, 0.1), V(-0.3, 1, 1), V(-1, -1, -0.2)}) {
            const Vec3d turned =
                turn.column[0] * double(d.x) + turn.column[1] * double(d.y) + turn.column[2] * double(d.z);
            EXPECT_EQ(along(degrees, V(turned)), along(0, d)) << degrees;
        }
    }
    // The poles and the axes have one texel too.
    for (const V& d : {V(0, 1, 0), V(0, -1, 0), V(0, 0, 1), V(0, 0, -1), V(1, 0, 0), V(-1, 0, 0)}) {
        EXPECT_GE(along(0, d), 1);
    }
}

TYPED_TEST(EnvironmentMapTest, IsOneOfTheLights) {
    const SceneEnvironment even = environment_with(1, 1, {Vec3d(1)});
    for (const std::uint32_t lights : {0u, 1u, 2u, 7u, 10000u}) {
        const auto table = environment_table<TypeParam>(even, lights, true);
        const EnvironmentMap<TypeParam>& map = table->map;
        const double share = (whole_share - map.object_share) / whole_share;
        EXPECT_NEAR(share, 1.0 / (lights + 1), 1e-9);
        EXPECT_NEAR(static_cast<double>(map.inverse_probability) * share, 1, 1e-7);
        if (lights > 0) {
            EXPECT_NEAR(static_cast<double>(map.inverse_object_probability) * (1 - share), 1, 1e-7);
        }
        // What is left to the objects is even over all words.
        for (const double part : {0.0, 0.25, 0.999}) {
            std::uint32_t word = static_cast<std::uint32_t>(part * map.object_share);
            if (lights > 0) {
                EXPECT_FALSE(draws_environment(map, word));
                EXPECT_NEAR(word / whole_share, part, 1e-6);
            }
        }
        std::uint32_t last = map.object_share - 1;
        EXPECT_EQ(draws_environment(map, last), lights == 0);
        EXPECT_GT(last, 0xfffff000u);
    }
    const auto half = environment_table<TypeParam>(even, 10000, false);
    EXPECT_EQ(half->map.inverse_probability, TypeParam(2));
}

TYPED_TEST(EnvironmentMapTest, OfBlackIsDrawnEvenly) {
    const auto table = environment_table<TypeParam>(environment_with(2, 2, std::vector<Vec3d>(4, Vec3d(0))), 0, true);
    for (std::uint32_t i = 0; i < 4; ++i) {
        EXPECT_NEAR(place_at(table->map, i / 2, i % 2).inverse_pdf, 4 * pi<double>, 1e-5);
    }
}

std::string hdr_of(std::uint32_t width, std::uint32_t height, const std::string& texels) {
    return "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y " + std::to_string(height) + " +X " + std::to_string(width) +
           "\n" + texels;
}

std::string refusal_of(const std::string& content) {
    try {
        (void)parse_hdr(content, "sky.hdr");
    } catch (const InputError& error) {
        return error.what();
    }
    return "accepted";
}

TEST(EnvironmentImage, ReadsRadianceFiles) {
    // Mantissas of red, green and blue, and an exponent: (128, 64, 0) 2^(129 - 136) = (1, 0.5, 0).
    const EnvironmentImage image =
        parse_hdr(hdr_of(2, 1, "\x80\x40" + std::string(1, '\0') + "\x81\x80\x80\x80\x82"), "");
    ASSERT_EQ(image.texels.size(), 2u);
    EXPECT_EQ(image.texels[0], Vec3<float>(1, 0.5f, 0));
    EXPECT_EQ(image.texels[1], Vec3<float>(2, 2, 2));
    // The row is encoded by runs: nine of one red, five and four greens, blues one by one, one exponent.
    const std::string row = std::string("\x02\x02\0\x09", 4) + "\x89\x80" + "\x85\x80\x84\x40" +
                            "\x09\x80\x80\x80\x80\x80\x80\x80\x80\x20" + "\x89\x81";
    const EnvironmentImage runs = parse_hdr(hdr_of(9, 1, row), "");
    ASSERT_EQ(runs.texels.size(), 9u);
    EXPECT_EQ(runs.texels[0], Vec3<float>(1, 1, 1));
    EXPECT_EQ(runs.texels[4], Vec3<float>(1, 1, 1));
    EXPECT_EQ(runs.texels[5], Vec3<float>(1, 0.5f, 1));
    EXPECT_EQ(runs.texels[8], Vec3<float>(1, 0.5f, 0.25f));
    // The image is encoded by older runs: a texel and seven more of it, 257 of another (256 by a second run).
    const std::string older =
        "\x80\x80\x80\x81\x01\x01\x01\x07" + std::string("\x80\x40\x40\x81\x01\x01\x01\0", 8) + "\x01\x01\x01\x01";
    const EnvironmentImage old_runs = parse_hdr(hdr_of(265, 1, older), "");
    ASSERT_EQ(old_runs.texels.size(), 265u);
    EXPECT_EQ(old_runs.texels[7], Vec3<float>(1, 1, 1));
    EXPECT_EQ(old_runs.texels[8], Vec3<float>(1, 0.5f, 0.5f));
    EXPECT_EQ(old_runs.texels[264], Vec3<float>(1, 0.5f, 0.5f));
}

// A texel of 128, 64, 32 and exponent 129, (1, 0.5, 0.25), under lines of the header.
EnvironmentImage hdr_under(const std::string& lines) {
    return parse_hdr("#?RADIANCE\n" + lines + "FORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\n\x80\x40\x20\x81", "sky.hdr");
}

// Light is what it was before it was multiplied; a line that is indented tells of an earlier image.
TEST(EnvironmentImage, DividesOutWhatAnHdrSaysThatLightWasMultipliedBy) {
    const auto texel = [](const std::string& lines) { return hdr_under(lines).texels.at(0); };
    EXPECT_EQ(texel(""), Vec3<float>(1, 0.5f, 0.25f));
    EXPECT_FALSE(hdr_under("").was_multiplied);
    EXPECT_EQ(texel("EXPOSURE=4\n"), Vec3<float>(0.25f, 0.125f, 0.0625f));
    EXPECT_TRUE(hdr_under("EXPOSURE=4\n").was_multiplied);
    EXPECT_EQ(texel("EXPOSURE=  +4.0e0 \r\nSOFTWARE=x\nEXPOSURE=0.5\n"), Vec3<float>(0.5f, 0.25f, 0.125f));
    EXPECT_EQ(texel("EXPOSURE=3\n"), Vec3<float>(1.0f / 3, 0.5f / 3, 0.25f / 3));
    EXPECT_EQ(texel("COLORCORR=2 1 0.5\nEXPOSURE=2\n"), Vec3<float>(0.25f, 0.25f, 0.25f));
    EXPECT_EQ(texel("\tEXPOSURE=4\n\tVIEW= -vtv\n# EXPOSURE=9\nGAMMA=1.0\nPIXASPECT=2\n"
                    "PRIMARIES= .640 .330 .290 .600 .150 .060 .333 .333\n"),
              Vec3<float>(1, 0.5f, 0.25f));
}

TEST(EnvironmentImage, RefusesLinesThatMakeOtherLightOfAnHdr) {
    for (const auto& [line, allowed] :
         {std::pair{"GAMMA=2.2", "no GAMMA, or 1: numbers in proportion to light"},
          {"EXPOSURE=0", "EXPOSURE= and a number from 1e-30 to 1e30"},
          {"EXPOSURE=4 4", "EXPOSURE= and a number from 1e-30 to 1e30"},
          {"EXPOSURE=nan", "EXPOSURE= and a number from 1e-30 to 1e30"},
          {"EXPOSURE=1e-40", "EXPOSURE= and a number from 1e-30 to 1e30"},
          {"EXPOSURE=", "EXPOSURE= and a number from 1e-30 to 1e30"},
          {"COLORCORR=1 1", "COLORCORR= and three numbers from 1e-30 to 1e30"},
          {"COLORCORR=1 1 -1", "COLORCORR= and three numbers from 1e-30 to 1e30"},
          {"VIEW= -vtv -vh 90", "no VIEW: an equirectangular image of all round, which no view of Radiance is"},
          {"PRIMARIES=0.7 0.3 0.2 0.7 0.15 0.06 0.33 0.33", "no PRIMARIES, or those of Radiance or sRGB"}}) {
        try {
            (void)hdr_under(std::string(line) + "\n");
            ADD_FAILURE() << line;
        } catch (const InputError& error) {
            EXPECT_EQ(error.what(), std::string("sky.hdr: header: found \"") + line + "\", allowed: " + allowed);
        }
    }
}

TEST(EnvironmentImage, RefusesWhatIsNone) {
    const std::string whole =
        ", allowed: a whole Radiance image: #?RADIANCE, FORMAT=32-bit_rle_rgbe, -Y HEIGHT +X WIDTH, texels";
    EXPECT_EQ(refusal_of(""), "sky.hdr: content: found no header" + whole);
    EXPECT_EQ(refusal_of("hello\n"), "sky.hdr: content: found no #?RADIANCE at its beginning" + whole);
    EXPECT_EQ(refusal_of("#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n"),
              "sky.hdr: content: found \"FORMAT=32-bit_rle_xyze\"" + whole);
    EXPECT_EQ(refusal_of("#?RADIANCE\n\n+Y 1 +X 1\n    "), "sky.hdr: content: found \"+Y 1 +X 1\"" + whole);
    EXPECT_EQ(refusal_of("#?RADIANCE\n\n-Y 1 +X 1x\n    "), "sky.hdr: content: found \"-Y 1 +X 1x\"" + whole);
    EXPECT_EQ(refusal_of(hdr_of(1, 1, "\x80\x80\x80")), "sky.hdr: content: found a file that ends early" + whole);
    EXPECT_EQ(refusal_of(hdr_of(9, 1, std::string("\x02\x02\0\x09", 4) + "\x8a\x80")),
              "sky.hdr: content: found a run beyond its row" + whole);
    EXPECT_EQ(refusal_of(hdr_of(8, 1, "\x80\x80\x80\x81\x01\x01\x01\x08")),
              "sky.hdr: content: found a run beyond its row" + whole);
    EXPECT_EQ(refusal_of(hdr_of(2, 1, "\x01\x01\x01\x01\x80\x80\x80\x81")),
              "sky.hdr: content: found a run beyond its row" + whole);
    EXPECT_EQ(refusal_of(hdr_of(9000, 1, "")), "sky.hdr: size: found 9000 x 1 texels, allowed: 1 x 1 to 8192 x 4096");
    EXPECT_EQ(refusal_of(hdr_of(0, 0, "")), "sky.hdr: size: found 0 x 0 texels, allowed: 1 x 1 to 8192 x 4096");
    const std::string bright = refusal_of(hdr_of(1, 1, "\xff\xff\xff\xff"));
    EXPECT_EQ(bright.find("sky.hdr: texel 0, 0: found 1.69"), 0u) << bright;
    EXPECT_THROW((void)read_environment_image("/nowhere/sky.hdr"), InputError);
    try {
        (void)read_environment_image("/nowhere/sky.png");
        FAIL();
    } catch (const InputError& error) {
        EXPECT_STREQ(error.what(), "/nowhere/sky.png: file name: found the ending \".png\", allowed: .hdr or .exr");
    }
}

TEST(EnvironmentImage, ExrComesBackAsItWas) {
    const EnvironmentImage image{3,
                                 2,
                                 {Vec3<float>(1, 2, 3), Vec3<float>(0), Vec3<float>(1e8f, 0.1f, 1e-20f), Vec3<float>(4),
                                  Vec3<float>(5), Vec3<float>(6)}};
    if (!has_openexr()) {
        EXPECT_THROW((void)parse_exr("", "sky.exr"), InputError);
        return;
    }
    const std::string content = encode_environment_exr(image);
    const EnvironmentImage back = parse_exr(content, "sky.exr");
    EXPECT_EQ(back.width, 3u);
    EXPECT_EQ(back.height, 2u);
    EXPECT_EQ(back.texels, image.texels);
    // An image with the channel Y alone is read as grey.
    const EnvironmentImage grey = parse_exr(encode_exr({{"", "Y", {1, 2}}}, 2, 1), "sky.exr");
    EXPECT_EQ(grey.texels, (std::vector<Vec3<float>>{Vec3<float>(1), Vec3<float>(2)}));
    for (const std::string& broken : {std::string("hello"), std::string(), content.substr(0, content.size() / 2),
                                      encode_exr({{"", "RG", {1, 2}}}, 1, 1)}) {
        EXPECT_THROW((void)parse_exr(broken, "sky.exr"), InputError);
    }
    try {
        (void)parse_exr(encode_exr({{"", "RGB", {1, 2, -3}}}, 1, 1), "sky.exr");
        FAIL();
    } catch (const InputError& error) {
        EXPECT_STREQ(error.what(), "sky.exr: texel 0, 0: found -3, allowed: a number from 0 to 1e30");
    }
}

}  // namespace
}  // namespace pt
