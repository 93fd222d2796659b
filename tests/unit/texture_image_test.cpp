// Images that surfaces show: what a file's numbers become, which way up, and what is refused; and the scenes that name
// them.
#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "harness/failure.h"
#include "harness/scene/scene.h"
#include "tests/support/command.h"
#include "tests/support/places.h"

// These functions are those of stb_image_write.h, which harness/render/image.cpp compiles.
extern "C" int stbi_write_png_to_func(void (*write)(void*, void*, int), void* context, int width, int height,
                                      int channels, const void* data, int stride);
extern "C" int stbi_write_jpg_to_func(void (*write)(void*, void*, int), void* context, int width, int height,
                                      int channels, const void* data, int quality);

namespace pt {
namespace {

const std::string source_folder = test::source_folder();

void append(void* context, void* data, int size) {
    static_cast<std::string*>(context)->append(static_cast<const char*>(data), static_cast<std::size_t>(size));
}

std::string png(int width, int height, int channels, const std::vector<unsigned char>& values) {
    std::string content;
    EXPECT_NE(stbi_write_png_to_func(append, &content, width, height, channels, values.data(), width * channels), 0);
    return content;
}

std::string jpeg(int width, int height, const std::vector<unsigned char>& values) {
    std::string content;
    EXPECT_NE(stbi_write_jpg_to_func(append, &content, width, height, 3, values.data(), 100), 0);
    return content;
}

std::string big_endian(std::uint32_t value, int bytes) {
    std::string text;
    for (int i = bytes - 1; i >= 0; --i) {
        text += static_cast<char>(value >> (8 * i) & 0xff);
    }
    return text;
}

// One row of 16-bit numbers, stored; stb_image asks for no checksum.
std::string png_of_16_bits(std::uint32_t width, const std::vector<std::uint32_t>& values) {
    std::string row(1, '\0');
    for (const std::uint32_t value : values) {
        row += big_endian(value, 2);
    }
    const auto size = static_cast<std::uint32_t>(row.size());
    const std::string length{static_cast<char>(size & 0xff), static_cast<char>(size >> 8),
                             static_cast<char>(~size & 0xff), static_cast<char>(~size >> 8 & 0xff)};
    const auto chunk = [](const std::string& kind, const std::string& data) {
        return big_endian(static_cast<std::uint32_t>(data.size()), 4) + kind + data + std::string(4, '\0');
    };
    return "\x89PNG\r\n\x1a\n" +
           chunk("IHDR", big_endian(width, 4) + big_endian(1, 4) + std::string("\x10\x02\0\0\0", 5)) +
           chunk("IDAT", "\x78\x01\x01" + length + row + std::string(4, '\0')) + chunk("IEND", "");
}

std::string refused(const std::string& content) {
    try {
        (void)parse_texture_image(content, "a.png");
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

TEST(TextureImage, IsLinearAndFromTheBottomUp) {
    const TextureImage image =
        parse_texture_image(png(2, 2, 3, {0, 255, 128, 10, 11, 12, 188, 1, 2, 255, 255, 255}), "a.png");
    ASSERT_EQ(image.width, 2u);
    ASSERT_EQ(image.height, 2u);
    const auto linear = [](int value) { return static_cast<float>(srgb_to_linear(value / 255.0)); };
    EXPECT_EQ(image.texels[0], Vec3<float>(linear(188), linear(1), linear(2)));
    EXPECT_EQ(image.texels[1], Vec3<float>(1, 1, 1));
    EXPECT_EQ(image.texels[2], Vec3<float>(0, 1, linear(128)));
    EXPECT_EQ(image.texels[3], Vec3<float>(linear(10), linear(11), linear(12)));
    // IEC 61966-2-1: half of the light is about 188, and the two pieces meet.
    EXPECT_NEAR(linear(188), 0.5029, 5e-5);
    EXPECT_NEAR(srgb_to_linear(0.04045), std::pow((0.04045 + 0.055) / 1.055, 2.4), 1e-7);
    EXPECT_EQ(srgb_to_linear(1), 1);
}

TEST(TextureImage, MayBeGreyOrHaveAnAlphaChannel) {
    const float middle = static_cast<float>(srgb_to_linear(100 / 255.0));
    EXPECT_EQ(parse_texture_image(png(1, 1, 1, {100}), "a.png").texels[0], Vec3<float>(middle));
    EXPECT_EQ(parse_texture_image(png(1, 1, 2, {100, 7}), "a.png").texels[0], Vec3<float>(middle));
    EXPECT_EQ(parse_texture_image(png(1, 1, 4, {100, 100, 255, 0}), "a.png").texels[0], Vec3<float>(middle, middle, 1));
}

TEST(TextureImage, MayHaveSixteenBits) {
    const TextureImage image = parse_texture_image(png_of_16_bits(2, {0, 65535, 1, 30000, 40000, 50000}), "a.png");
    const auto linear = [](int value) { return static_cast<float>(srgb_to_linear(value / 65535.0)); };
    EXPECT_EQ(image.texels[0], Vec3<float>(0, 1, linear(1)));
    EXPECT_EQ(image.texels[1], Vec3<float>(linear(30000), linear(40000), linear(50000)));
}

TEST(TextureImage, OfNumbersIsTheFirstChannelAsItIs) {
    const auto parse = [](const std::string& content) {
        return parse_texture_image(content, "a.png", TexelMeaning::number);
    };
    const auto share = [](int value, double most) { return Vec3<float>(static_cast<float>(value / most)); };
    const TextureImage image = parse(png(2, 1, 3, {0, 255, 128, 100, 11, 12}));
    EXPECT_EQ(image.texels, (std::vector<Vec3<float>>{share(0, 255), share(100, 255)}));
    EXPECT_EQ(parse(png(1, 1, 1, {100})).texels[0], share(100, 255));
    EXPECT_EQ(parse(png(1, 1, 2, {100, 7})).texels[0], share(100, 255));
    EXPECT_EQ(parse(png(1, 1, 4, {255, 7, 7, 7})).texels[0], share(255, 255));
    const TextureImage fine = parse(png_of_16_bits(2, {30000, 65535, 1, 65535, 40000, 50000}));
    EXPECT_EQ(fine.texels, (std::vector<Vec3<float>>{share(30000, 65535), share(65535, 65535)}));
}

TEST(TextureImage, OfNormalsIsSignedAndPointsOutward) {
    const auto parse = [](const std::string& content) {
        return parse_texture_image(content, "a.png", TexelMeaning::normal);
    };
    const auto share = [](int value) { return static_cast<float>(value / 127.0); };
    const TextureImage image = parse(png(2, 2, 3, {128, 128, 255, 255, 1, 129, 0, 200, 128, 64, 64, 0}));
    EXPECT_EQ(image.texels[0], Vec3<float>(0, 0, 1));  // lies in the surface
    EXPECT_EQ(image.texels[1], Vec3<float>(0, 0, 1));  // points inward
    EXPECT_EQ(image.texels[2], Vec3<float>(0, 0, 1));
    EXPECT_EQ(image.texels[3], Vec3<float>(1, -1, share(1)));
    EXPECT_EQ(parse(png(1, 1, 4, {0, 192, 192, 7})).texels[0], Vec3<float>(-1, share(64), share(64)));
    const TextureImage fine = parse(png_of_16_bits(2, {32768, 32768, 65535, 1, 0, 49152}));
    EXPECT_EQ(fine.texels[0], Vec3<float>(0, 0, 1));
    EXPECT_EQ(fine.texels[1], Vec3<float>(-1, -1, static_cast<float>(16384 / 32767.0)));
    for (const int channels : {1, 2}) {
        try {
            (void)parse(png(1, 1, channels, {200, 255}));
            FAIL();
        } catch (const InputError& error) {
            EXPECT_STREQ(error.what(), "a.png: content: found a grey image, allowed: normals, as red, green and blue");
        }
    }
}

TEST(TextureImage, MayBeAJpeg) {
    const TextureImage image = parse_texture_image(jpeg(16, 8, std::vector<unsigned char>(16 * 8 * 3, 200)), "a.jpg");
    EXPECT_EQ(image.width, 16u);
    EXPECT_EQ(image.height, 8u);
    for (const Vec3<float>& texel : image.texels) {
        EXPECT_NEAR(texel.x, srgb_to_linear(200 / 255.0), 0.02);  // two steps of 255: what the encoder rounds
    }
}

TEST(TextureImage, ThatIsNoneIsRefused) {
    EXPECT_EQ(refused(""), "a.png: content: found no header of either, allowed: a whole PNG or JPEG image");
    EXPECT_EQ(refused("GIF89a" + std::string(100, ' ')),
              "a.png: content: found no header of either, allowed: a whole PNG or JPEG image");
    const std::string whole = png(8, 8, 3, std::vector<unsigned char>(8 * 8 * 3, 7));
    for (std::size_t length = 0; length < whole.size() - 12; ++length) {  // what is left are the bytes of IEND
        EXPECT_NE(refused(whole.substr(0, length)).find("a whole PNG or JPEG image"), std::string::npos) << length;
    }
    const std::string photo = jpeg(16, 16, std::vector<unsigned char>(16 * 16 * 3, 90));
    for (std::size_t length = 0; length < photo.size() - 1; ++length) {
        EXPECT_NE(refused(photo.substr(0, length)).find("a whole PNG or JPEG image"), std::string::npos) << length;
    }
    std::string wide = png(1, 1, 3, {1, 2, 3});
    wide.replace(16, 4, big_endian(8193, 4));
    EXPECT_EQ(refused(wide), "a.png: size: found 8193 x 1 texels, allowed: 1 x 1 to 8192 x 8192");
    EXPECT_THROW((void)read_texture_image("none.png"), InputError);
    try {
        (void)read_texture_image("a.gif");
        FAIL();
    } catch (const InputError& error) {
        EXPECT_STREQ(error.what(), "a.gif: file name: found the ending \".gif\", allowed: .png, .jpg or .jpeg");
    }
}

// A scene with the material and the object, in the folder of the tiles.
std::string text_of_scene(const std::string& material, const std::string& object) {
    return R"({"name": "s", "max_depth": 2, "environment": [1, 1, 1],
               "camera": {"eye": [0, 0, 3], "look_at": [0, 0, 0], "up": [0, 1, 0], "vertical_fov_degrees": 40,
                          "resolution": [4, 4]},
               "materials": {"m": )" +
           material + R"(}, "objects": [{"material": "m", )" + object + "}]}";
}

constexpr const char* tiled = R"({"type": "diffuse", "albedo": {"image": "tiles.png"}})";
constexpr const char* one_triangle =
    R"("shape": "mesh", "vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "triangles": [[0, 1, 2]])";

Scene scene_of(const std::string& material, const std::string& object) {
    return parse_scene(text_of_scene(material, object), source_folder + "/scenes/textures/s.json");
}

std::string refused_scene(const std::string& material, const std::string& object) {
    try {
        (void)scene_of(material, object);
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

TEST(TexturedScene, NamesAnImageInPlaceOfAColour) {
    const Scene scene = scene_of(tiled, R"("shape": "sphere")");
    const SceneMaterial& material = scene.materials[0];
    ASSERT_NE(material.texture, nullptr);
    EXPECT_EQ(material.texture->file, "tiles.png");
    EXPECT_EQ(material.texture->image.width, 32u);
    EXPECT_EQ(material.texture->image.texels.size(), 32u * 32);
    EXPECT_TRUE(contains(features_of(scene), Feature::textures));
    const auto linear = [](int value) {
        return static_cast<double>(static_cast<float>(srgb_to_linear(value / 255.0)));
    };
    EXPECT_EQ(material.albedo, Vec3d(linear(230), linear(210), linear(200)));  // the largest by channel
    EXPECT_EQ(Vec3d(material.texture->image.texels[33]), Vec3d(linear(200), linear(40), linear(30)));  // lower left
    for (const char* const metal :
         {R"({"type": "mirror", "reflectance": {"image": "tiles.png"}})",
          R"({"type": "rough_conductor", "roughness": 0.2, "reflectance": {"image": "tiles.png"}})"}) {
        const Scene shown = scene_of(metal, R"("shape": "box")");
        EXPECT_NE(shown.materials[0].texture, nullptr);
        EXPECT_EQ(shown.materials[0].reflectance, material.albedo);
    }
    const char* const mix =
        R"({"type": "mix", "mirror_probability": 0.5, "reflectance": [1, 1, 1], "albedo": {"image": "tiles.png"}})";
    EXPECT_NE(scene_of(mix, R"("shape": "quad")").materials[0].texture, nullptr);
    // A material that nothing is made of needs nothing.
    const Scene plain =
        scene_of(R"({"type": "diffuse", "albedo": [1, 1, 1]}, "n": )" + std::string(tiled), R"("shape": "box")");
    EXPECT_FALSE(contains(features_of(plain), Feature::textures));
}

constexpr const char* tiled_metal =
    R"({"type": "rough_conductor", "reflectance": [1, 1, 1], "roughness": {"image": "tiles.png"}})";

TEST(TexturedScene, NamesAnImageInPlaceOfARoughness) {
    const auto share = [](int value) { return static_cast<float>(value / 255.0); };
    for (const char* const rough :
         {tiled_metal, R"({"type": "rough_dielectric", "ior": 1.5, "roughness": {"image": "tiles.png"}})"}) {
        const Scene scene = scene_of(rough, R"("shape": "box")");
        const SceneMaterial& material = scene.materials[0];
        EXPECT_EQ(material.texture, nullptr);
        ASSERT_NE(material.roughness_texture, nullptr);
        EXPECT_EQ(material.roughness_texture->file, "tiles.png");
        EXPECT_EQ(material.roughness, static_cast<double>(share(230)));                    // the largest
        EXPECT_EQ(material.roughness_texture->image.texels[33], Vec3<float>(share(200)));  // lower left
        EXPECT_TRUE(contains(features_of(scene), Feature::textures));
    }
    const Scene both = scene_of(R"({"type": "rough_conductor", "reflectance": {"image": "tiles.png"},
                                    "roughness": {"image": "tiles.png"}})",
                                R"("shape": "box")");
    EXPECT_EQ(both.materials[0].texture->image.texels[33].x, static_cast<float>(srgb_to_linear(200 / 255.0)));
    EXPECT_EQ(both.materials[0].roughness_texture->image.texels[33].x, share(200));
}

TEST(TexturedScene, HashesItsImagesAndCoordinates) {
    const std::string base = scene_of(tiled, R"("shape": "sphere")").hash;
    EXPECT_EQ(scene_of(tiled, R"("shape": "sphere")").hash, base);
    const test::TemporaryFolder folder;
    test::write_text(folder.file("tiles.png"), png(1, 1, 3, {1, 2, 3}));
    EXPECT_NE(parse_scene(text_of_scene(tiled, R"("shape": "sphere")"), folder.file("s.json")).hash, base);
    EXPECT_NE(parse_scene(text_of_scene(tiled_metal, R"("shape": "box")"), folder.file("s.json")).hash,
              scene_of(tiled_metal, R"("shape": "box")").hash);
}

TEST(TexturedScene, NeedsCoordinatesOfItsMeshes) {
    const std::string with = std::string(one_triangle) + R"(, "texture_coordinates": [[0, 0], [1, 0.5], [0.25, 2]])";
    const Scene scene = scene_of(tiled, with);
    ASSERT_EQ(scene.meshes[0]->coordinates.size(), 1u);
    const CornerCoordinates& corners = scene.meshes[0]->coordinates[0];
    // The least corner stands first: (0, 0, 0), then (1, 0, 0), (0, 1, 0).
    EXPECT_EQ(corners.u[0], 0);
    EXPECT_EQ(corners.u[1], 1);
    EXPECT_EQ(corners.v[1], 0.5f);
    EXPECT_EQ(corners.u[2], 0.25f);
    EXPECT_EQ(corners.v[2], 2);
    EXPECT_NE(refused_scene(tiled, one_triangle)
                  .find("on the mesh of the scene file, which has no texture coordinates: a material without an image"),
              std::string::npos)
        << refused_scene(tiled, one_triangle);
    for (const char* const material : {tiled, tiled_metal}) {
        EXPECT_NE(refused_scene(material, R"("shape": "mesh", "generate": {"mesh": "icosphere", "size": 1})")
                      .find("which has no texture coordinates"),
                  std::string::npos);
    }
    EXPECT_EQ(scene_of(tiled_metal, with).meshes[0]->coordinates.size(), 1u);
    // A mesh with other coordinates, or none, is another mesh.
    const Scene plain = scene_of(R"({"type": "diffuse", "albedo": [1, 1, 1]})", one_triangle);
    EXPECT_TRUE(plain.meshes[0]->coordinates.empty());
    EXPECT_EQ(plain.meshes[0]->hash, scene.meshes[0]->hash);
}

TEST(TexturedScene, WhoseRoughnessIsWrongIsRefusedInOneLine) {
    for (const auto& [roughness, expected] : std::vector<std::pair<std::string, std::string>>{
             {R"({"image": "none.png"})", "none.png"},
             {R"({"image": "textures.json"})", "allowed: .png, .jpg or .jpeg"},
             {R"({"image": 3})", "$.materials.m.roughness.image"},
             {R"({"file": "tiles.png"})", "$.materials.m.roughness: found unknown key \"file\", allowed: image"},
             {R"({"image": "tiles.png", "scale": 2})", "scale"},
             {R"("tiles.png")",
              "$.materials.m.roughness: found \"tiles.png\", allowed: a number from 0 to 1, or {\"image\": NAME}"},
             {"[0.5, 0.5, 0.5]", "allowed: a number from 0 to 1"},
             {"{}", "image"}}) {
        for (const char* const type :
             {R"("rough_conductor", "reflectance": [1, 1, 1])", R"("rough_dielectric", "ior": 1.5)"}) {
            const std::string message = refused_scene(
                R"({"type": )" + std::string(type) + R"(, "roughness": )" + roughness + "}", R"("shape": "box")");
            EXPECT_NE(message.find(expected), std::string::npos) << roughness << ": " << message;
            EXPECT_EQ(message.find('\n'), std::string::npos);
        }
    }
    // Images are of what the format names.
    EXPECT_NE(refused_scene(R"({"type": "mirror", "reflectance": [1, 1, 1], "roughness": {"image": "tiles.png"}})",
                            R"("shape": "box")")
                  .find("unknown key \"roughness\""),
              std::string::npos);
}

TEST(TexturedScene, MayHaveANormalMapOnAllThatReflects) {
    const std::string normal = R"("normal": {"image": "tiles.png", "scale": -0.5}})";
    std::set<std::string> hashes;
    for (const char* const rest :
         {R"("diffuse", "albedo": [1, 1, 1], )", R"("mirror", "reflectance": [1, 1, 1], )",
          R"("mix", "albedo": [1, 1, 1], "reflectance": [1, 1, 1], "mirror_probability": 0.5, )",
          R"("dielectric", "ior": 1.5, )", R"("rough_dielectric", "ior": 1.5, "roughness": 0.5, )",
          R"("rough_conductor", "reflectance": [1, 1, 1], "roughness": 0.5, )",
          R"("principled", "base_colour": [1, 1, 1], "roughness": 0.5, )"}) {
        const std::string type = std::string(R"({"type": )") + rest;
        const Scene scene = scene_of(type + normal, R"("shape": "box")");
        ASSERT_NE(scene.materials[0].normal_texture, nullptr) << rest;
        EXPECT_EQ(scene.materials[0].normal_scale, -0.5);
        EXPECT_TRUE(contains(features_of(scene), Feature::textures));
        EXPECT_TRUE(contains(features_of(scene), Feature::shading_normals));
        EXPECT_EQ(
            scene_of(type + R"("normal": {"image": "tiles.png"}})", R"("shape": "box")").materials[0].normal_scale, 1);
        EXPECT_NE(refused_scene(type + normal, R"("shape": "mesh", "generate": {"mesh": "icosphere", "size": 0})")
                      .find("which has no texture coordinates"),
                  std::string::npos);
        hashes.insert(scene.hash);
    }
    EXPECT_EQ(hashes.size(), 7u);
    for (const auto& [wrong, expected] : std::vector<std::pair<std::string, std::string>>{
             {R"({"image": "none.png"})", "none.png"},
             {R"({"image": "tiles.png", "scale": 1e4})",
              "$.materials.m.normal.scale: found 10000.0, allowed: a number from -1000 to 1000"},
             {R"({"image": "tiles.png", "size": 1})", "$.materials.m.normal: found unknown key \"size\""},
             {"[0, 0, 1]", "$.materials.m.normal"},
             {"{}", "image"}}) {
        const std::string message =
            refused_scene(R"({"type": "diffuse", "albedo": [1, 1, 1], "normal": )" + wrong + "}", R"("shape": "box")");
        EXPECT_NE(message.find(expected), std::string::npos) << wrong << ": " << message;
        EXPECT_EQ(message.find('\n'), std::string::npos);
    }
    for (const char* const none :
         {R"("emitter", "radiance": [1, 1, 1], )", R"("subsurface", "sigma_s": [1, 1, 1], )"}) {
        EXPECT_NE(refused_scene(std::string(R"({"type": )") + none + normal, R"("shape": "box")")
                      .find("unknown key \"normal\""),
                  std::string::npos);
    }
}

TEST(TexturedScene, ThatIsWrongIsRefusedInOneLine) {
    const auto material = [](const std::string& albedo) {
        return refused_scene(R"({"type": "diffuse", "albedo": )" + albedo + "}", R"("shape": "box")");
    };
    for (const auto& [albedo, expected] : std::vector<std::pair<std::string, std::string>>{
             {R"({"image": "none.png"})", "none.png"},
             {R"({"image": "textures.json"})", "allowed: .png, .jpg or .jpeg"},
             {R"({"image": 3})", "$.materials.m.albedo.image"},
             {R"({"file": "tiles.png"})", "$.materials.m.albedo"},
             {R"({"image": "tiles.png", "scale": 2})", "scale"},
             {R"("tiles.png")", "allowed: an array of 3 numbers, or {\"image\": NAME}"},
             {"{}", "image"}}) {
        const std::string message = material(albedo);
        EXPECT_NE(message.find(expected), std::string::npos) << albedo << ": " << message;
        EXPECT_EQ(message.find('\n'), std::string::npos);
    }
    const std::string mesh = one_triangle;
    for (const auto& [coordinates, expected] : std::vector<std::pair<std::string, std::string>>{
             {"[[0, 0], [1, 0]]", "one for each of the 3 vertices"},
             {"[[0, 0], [1, 0], [0]]", "[u, v]"},
             {"[[0, 0], [1, 0], [0, 1e7]]", "a number from -1e6 to 1e6"}}) {
        const std::string message = refused_scene(tiled, mesh + ", \"texture_coordinates\": " + coordinates);
        EXPECT_NE(message.find(expected), std::string::npos) << message;
    }
    EXPECT_NE(refused_scene(tiled, R"("shape": "mesh", "generate": {"mesh": "icosphere", "size": 1},
                                      "texture_coordinates": [[0, 0]])")
                  .find("\"texture_coordinates\" with \"vertices\""),
              std::string::npos);
}

}  // namespace
}  // namespace pt
