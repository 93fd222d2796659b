// glTF scenes of a few bytes: where every vertex stands, what each material is read as, and what is told.
#include "harness/interchange/import_gltf.h"

#include <cmath>
#include <cstring>

#include <fmt/ranges.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "harness/interchange/import_scene.h"
#include "harness/mesh/read_mesh.h"
#include "harness/scene/scene_mesh.h"
#include "harness/scene/texture_image.h"
#include "tests/support/command.h"
#include "tests/support/places.h"

namespace pt::test {
namespace {

using Json = nlohmann::json;
using Lines = std::vector<std::string>;

std::string base64(const std::string& bytes) {
    constexpr const char* letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t three = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            three = three << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
        }
        for (std::size_t k = 0; k < 4; ++k) {
            text += i + k > bytes.size() ? '=' : letters[three >> (18 - 6 * k) & 63u];
        }
    }
    return text;
}

template <class T>
std::string bytes_of(const std::vector<T>& values) {
    std::string bytes(values.size() * sizeof(T), '\0');
    std::memcpy(bytes.data(), values.data(), bytes.size());
    return bytes;
}

// A triangle, in one buffer of positions and indices: (0, 0, 0), (1, 0, 0), (0, 2, 0).
const std::string buffer = bytes_of<float>({0, 0, 0, 1, 0, 0, 0, 2, 0}) + bytes_of<std::uint16_t>({0, 1, 2});

// Node 0 looks at what node 1 shows.
Json document() {
    return Json::parse(R"({
      "asset": {"version": "2.0"},
      "scene": 0, "scenes": [{"nodes": [0, 1]}],
      "nodes": [{"camera": 0, "translation": [0, 0, 5]}, {"mesh": 0}],
      "cameras": [{"type": "perspective", "perspective": {"yfov": 0.5, "aspectRatio": 2, "znear": 0.1}}],
      "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}],
      "materials": [{"name": "lamp", "pbrMetallicRoughness": {"baseColorFactor": [0, 0, 0, 1], "metallicFactor": 0},
                     "emissiveFactor": [1, 0.5, 0.25],
                     "extensions": {"KHR_materials_specular": {"specularFactor": 0}}}],
      "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
                    {"bufferView": 1, "componentType": 5123, "count": 3, "type": "SCALAR"}],
      "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 6}],
      "buffers": [{"byteLength": 42, "uri": ""}]})");
}

struct Gltf {
    explicit Gltf(Json json) {
        if (json.at("buffers")[0].value("uri", "") == "") {
            json["buffers"][0]["uri"] = "data:application/octet-stream;base64," + base64(buffer);
        }
        read(json.dump());
    }
    explicit Gltf(const std::string& text) { read(text); }

    void read(const std::string& text) {
        result = import_gltf({.text = text, .file = "in/small.gltf", .out = "back.json", .name = ""});
        MeshesToBe::Meshes meshes;
        for (const ImportedMesh& imported : result.meshes) {
            meshes[imported.file] = make_scene_mesh(imported.mesh, imported.file, true);
        }
        const MeshesToBe to_be(std::move(meshes));
        ImagesToBe::Contents images;
        for (const ImportedImage& imported : result.images) {
            images[imported.file] = imported.content;
        }
        const ImagesToBe images_to_be(std::move(images));
        if (!result.json.empty()) {
            scene = parse_scene(result.json, "back.json");
        }
    }
    Lines problems() const { return result.problems.messages("f", ""); }
    Lines warnings() const { return result.warnings.messages("f", ""); }
    Lines notes() const { return result.notes.messages("f", ""); }
    const SceneMaterial& material(std::size_t object = 0) const {
        return scene.materials[scene.objects.at(object).material];
    }
    // The corners of an object's first triangle, where it stands.
    std::vector<Vec3d> corners(std::size_t object) const {
        const SceneObject& shown = scene.objects.at(object);
        const Triangle<float> t = placed_triangles(*scene.meshes[shown.mesh], placement_of(shown, Vec3d(0.0))).front();
        return {Vec3d(t.a), Vec3d(t.b), Vec3d(t.c)};
    }

    ImportResult result;
    Scene scene;
};

class ImportGltfTest : public testing::Test {
protected:
    void SetUp() override {
        if (!reads_glb()) {
            GTEST_SKIP() << "this build has no reader for glTF";
        }
    }
};

TEST_F(ImportGltfTest, AWholeSceneAndWhatGltfLeavesOpen) {
    const Gltf read(document());
    EXPECT_EQ(read.problems(), Lines());
    EXPECT_EQ(read.warnings(), Lines());
    EXPECT_EQ(read.notes(), (Lines{"f: max_depth is 8: glTF has none",
                                   "f: /cameras/0 gets a picture of 1200 x 600 pixels: glTF has no number of them"}));
    EXPECT_EQ(read.scene.name, "small");
    EXPECT_EQ(read.scene.camera.eye, Vec3d(0, 0, 5));
    EXPECT_EQ(read.scene.camera.look_at, Vec3d(0, 0, 4));
    EXPECT_EQ(read.scene.camera.up, Vec3d(0, 1, 0));
    EXPECT_NEAR(read.scene.camera.vertical_fov_degrees, 0.5 * 180 / pi<double>, 1e-12);
    EXPECT_EQ(read.scene.camera.width, 1200u);
    EXPECT_EQ(read.scene.camera.height, 600u);
    EXPECT_EQ(read.material().type, MaterialType::emitter);
    EXPECT_EQ(read.material().name, "lamp");
    EXPECT_EQ(read.material().emission, Vec3d(1, 0.5, 0.25));
    ASSERT_EQ(read.result.meshes.size(), 1u);
    EXPECT_EQ(read.result.meshes[0].file, "back_mesh_0.ply");
    EXPECT_EQ(read.corners(0), (std::vector<Vec3d>{{0, 0, 0}, {1, 0, 0}, {0, 2, 0}}));
}

TEST_F(ImportGltfTest, NodesPlaceWhatIsBelowThem) {
    Json json = document();
    const double half = std::sqrt(0.5);
    json["nodes"] =
        Json::array({Json{{"camera", 0}, {"translation", {0, 0, 5}}},
                     Json{{"children", {2, 3}}, {"translation", {10, 0, 0}}, {"scale", {2, 2, 2}}},
                     // A quarter turn about z, as single precision has it.
                     Json{{"mesh", 0}, {"rotation", {0, 0, 0.70710677, 0.70710677}}, {"translation", {0, 1, 0}}},
                     Json{{"mesh", 0}, {"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1}}}});
    const Gltf read(json);
    EXPECT_EQ(read.problems(), Lines());
    EXPECT_LT(std::abs(half - 0.70710677), 1e-7);
    ASSERT_EQ(read.scene.objects.size(), 2u);
    EXPECT_EQ(read.scene.meshes.size(), 1u);  // instances
    EXPECT_EQ(read.scene.objects[0].translate, Vec3d(10, 2, 0));
    EXPECT_EQ(read.scene.objects[0].rotate_degrees, Vec3d(0, 0, 90));
    EXPECT_EQ(read.scene.objects[0].scale, Vec3d(2.0));
    EXPECT_EQ(read.corners(0), (std::vector<Vec3d>{{10, 2, 0}, {10, 4, 0}, {6, 2, 0}}));
    EXPECT_EQ(read.corners(1), (std::vector<Vec3d>{{20, 12, 14}, {22, 12, 14}, {20, 16, 14}}));
}

TEST_F(ImportGltfTest, AMirroredNodeIsAMeshOfItsOwn) {
    Json json = document();
    json["nodes"][1]["scale"] = {-1, 1, 1};
    const Gltf read(json);
    EXPECT_EQ(read.problems(), Lines());
    EXPECT_EQ(read.scene.objects[0].scale, Vec3d(1.0));
    // The triangle's front still faces +z: it goes round counter-clockwise.
    EXPECT_EQ(read.corners(0), (std::vector<Vec3d>{{-1, 0, 0}, {0, 0, 0}, {0, 2, 0}}));
    json["nodes"][1].erase("scale");
    json["nodes"][1]["matrix"] = {1, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    EXPECT_EQ(Gltf(json).corners(0), (std::vector<Vec3d>{{0, 0, 0}, {1, 0, 0}, {2, 2, 0}}));
}

TEST_F(ImportGltfTest, AMeshThatIsPlacedAnewStaysWhereItIsInDoublePrecision) {
    Json json = document();
    json["nodes"][1]["scale"] = {-1, 1, 1};
    json["nodes"][1]["translation"] = {500000.123, 4649776.42, 0};
    const Gltf read(json);
    EXPECT_EQ(read.problems(), Lines());
    EXPECT_EQ(read.scene.objects[0].translate, Vec3d(500000.123, 4649776.42, 0));
    ASSERT_EQ(read.result.meshes.size(), 2u);
    EXPECT_EQ(read.result.meshes[1].mesh.vertices[1], (std::array<float, 3>{-1, 0, 0}));
}

TEST_F(ImportGltfTest, AScaleOfZeroHidesOrFlattens) {
    Json json = document();
    json["nodes"].push_back({{"mesh", 0}, {"scale", {0, 0, 0}}, {"children", {0}}});
    json["scenes"][0]["nodes"] = {0, 1, 2};
    const Gltf hidden(json);
    EXPECT_EQ(hidden.problems(), Lines());
    EXPECT_EQ(hidden.warnings(), Lines());
    EXPECT_EQ(hidden.result.objects, 1u);
    EXPECT_EQ(hidden.notes()[2], "f: /nodes/2 has the scale 0, which hides it and what hangs on it: left out");
    json["nodes"][2] = {{"mesh", 0}, {"scale", {1, 1, 0}}, {"translation", {0, 0, 3}}};  // is flat already
    EXPECT_EQ(Gltf(json).problems(), Lines());
    EXPECT_EQ(Gltf(json).corners(1), (std::vector<Vec3d>{{0, 0, 3}, {1, 0, 3}, {0, 2, 3}}));
    json["nodes"][2]["scale"] = {1, 0, 1};
    const Gltf edge_on(json);
    EXPECT_EQ(edge_on.problems(), Lines());
    EXPECT_EQ(edge_on.result.objects, 1u);
    EXPECT_EQ(edge_on.notes()[2], "f: /nodes/2 is left out: its mesh has no area where it stands");
}

TEST_F(ImportGltfTest, AnEmptyRotationIsTold) {
    Json json = document();
    json["nodes"][1]["rotation"] = {0, 0, 0, 0};
    EXPECT_EQ(Gltf(json).warnings(), Lines{"f: /nodes/1/rotation is (0, 0, 0, 0), which is none: it turns nothing"});
}

TEST_F(ImportGltfTest, MetalIsARoughConductor) {
    Json json = document();
    json["materials"] = Json::parse(R"([{"pbrMetallicRoughness": {"baseColorFactor": [0.25, 0.5, 1, 1],
        "metallicFactor": 1, "roughnessFactor": 0.375}}])");
    const Gltf read(json);
    EXPECT_EQ(read.material().type, MaterialType::rough_conductor);
    EXPECT_EQ(read.material().reflectance, Vec3d(0.25, 0.5, 1));
    EXPECT_EQ(read.material().roughness, 0.375);
    EXPECT_EQ(read.warnings(), Lines{"f: /materials has none that emits: the environment is [1, 1, 1]"});
    EXPECT_EQ(read.scene.environment, Vec3d(1.0));
    json["materials"] = Json::parse("[{}]");  // white, metal and rough: what the format says
    EXPECT_EQ(Gltf(json).material().roughness, 1);
    json["materials"][0] = Json::parse(R"({"pbrMetallicRoughness": {"metallicFactor": 0.5}})");
    json["materials"][0] = Json::parse(R"({"extensions": {"KHR_materials_transmission": {"transmissionFactor": 1}}})");
    EXPECT_EQ(Gltf(json).material().type, MaterialType::rough_conductor);  // nothing passes through metal
}

const std::string other_formulas =
    " is read as principled: as glTF has it, but with Fresnel's formula for Schlick's, and beneath its coat 1 - "
    "max(F(n.v), F(n.l)) of a diffuse surface, not 1 - F(v.h), which gains light at grazing angles";

TEST_F(ImportGltfTest, BetweenMetalAndNotItIsPrincipled) {
    Json json = document();
    json["materials"] = Json::parse(R"([{"pbrMetallicRoughness": {"baseColorFactor": [0.25, 0.5, 1, 1],
        "metallicFactor": 0.5, "roughnessFactor": 0.375}, "extensions": {"KHR_materials_ior": {"ior": 1.25}}}])");
    const Gltf read(json);
    EXPECT_EQ(read.problems(), Lines());
    EXPECT_EQ(read.material().type, MaterialType::principled);
    EXPECT_EQ(read.material().albedo, Vec3d(0.25, 0.5, 1));
    EXPECT_EQ(read.material().metallic, 0.5);
    EXPECT_EQ(read.material().roughness, 0.375);
    EXPECT_EQ(read.material().transmission, 0);
    EXPECT_EQ(read.material().ior, 1.25);
    EXPECT_EQ(read.warnings()[0], "f: /materials/0" + other_formulas);
    json["materials"][0]["extensions"]["KHR_materials_specular"] = {{"specularFactor", 0}};
    EXPECT_EQ(Gltf(json).material().ior, 1);  // reflects nothing
    json["materials"][0]["extensions"]["KHR_materials_specular"] = {{"specularFactor", 0.25}};
    const Gltf weak(json);  // (0.25 / 2.25)^2 / 4 = (1 / 18)^2
    EXPECT_NEAR(weak.material().ior, 19.0 / 17, 1e-15);
    EXPECT_EQ(weak.warnings()[0],
              "f: /materials/0/extensions/KHR_materials_specular is read as index 1.118, which reflects 0.00309 at "
              "normal incidence, and white at grazing angles");
    json["materials"][0]["extensions"] = {{"KHR_materials_ior", {{"ior", 0}}}};
    EXPECT_EQ(Gltf(json).problems(),
              Lines{"f: found /materials/0/extensions/KHR_materials_ior/ior: 0, allowed: from 1 to 1e4 where nothing "
                    "passes through"});
}

TEST_F(ImportGltfTest, WhatIsNoMetalIsPrincipledAndDiffuseWithoutItsCoat) {
    Json json = document();
    json["materials"] = Json::parse(R"([{"pbrMetallicRoughness": {"baseColorFactor": [0.25, 0.5, 1, 1],
        "metallicFactor": 0}, "emissiveFactor": [1, 1, 0.5],
        "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 8}}}])");
    const Gltf read(json);
    EXPECT_EQ(read.material().type, MaterialType::principled);
    EXPECT_EQ(read.material().albedo, Vec3d(0.25, 0.5, 1));
    EXPECT_EQ(read.material().roughness, 1);
    EXPECT_EQ(read.material().ior, 1.5);
    EXPECT_EQ(read.material().emission, Vec3d(8, 8, 4));
    EXPECT_EQ(read.warnings(), Lines{"f: /materials/0" + other_formulas});
    json["materials"][0]["extensions"]["KHR_materials_specular"] = {{"specularFactor", 0}};
    const Gltf without(json);
    EXPECT_EQ(without.material().type, MaterialType::diffuse);
    EXPECT_EQ(without.material().albedo, Vec3d(0.25, 0.5, 1));
    EXPECT_EQ(without.warnings(), Lines());
    json["materials"][0]["extensions"].erase("KHR_materials_specular");
    json["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] = {0, 0, 0, 1};
    const Gltf lamp(json);
    EXPECT_EQ(lamp.material().type, MaterialType::emitter);
    EXPECT_EQ(lamp.warnings(),
              Lines{"f: /materials/0 is read as an emitter: its clear coat, which reflects 0.04 at normal incidence "
                    "and more at grazing angles, is left out (specularFactor 0 has none)"});
}

// A tetrahedron: glass needs an inside.
Json with_tetrahedron(const Json& material) {
    Json json = document();
    const std::string solid = bytes_of<float>({0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}) +
                              bytes_of<std::uint16_t>({0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3});
    json["buffers"][0] = {{"byteLength", solid.size()},
                          {"uri", "data:application/octet-stream;base64," + base64(solid)}};
    json["accessors"][0]["count"] = 4;
    json["accessors"][1]["count"] = 12;
    json["bufferViews"][0]["byteLength"] = 48;
    json["bufferViews"][1] = {{"buffer", 0}, {"byteOffset", 48}, {"byteLength", 24}};
    json["materials"][0] = material;
    return json;
}

TEST_F(ImportGltfTest, TransmissionIsGlass) {
    const Gltf read(with_tetrahedron(Json::parse(R"({"pbrMetallicRoughness": {"baseColorFactor": [0.5, 1, 1, 1],
        "metallicFactor": 0, "roughnessFactor": 0}, "extensions": {"KHR_materials_transmission": {"transmissionFactor": 1},
        "KHR_materials_ior": {"ior": 1.25}, "KHR_materials_volume": {"thicknessFactor": 1, "attenuationDistance": 2,
        "attenuationColor": [1, 0.5, 0.25]}}})")));
    EXPECT_EQ(read.problems(), Lines());
    EXPECT_EQ(read.warnings().size(), 1u);  // of the environment
    EXPECT_EQ(read.material().type, MaterialType::dielectric);
    EXPECT_EQ(read.material().ior, 1.25);
    EXPECT_EQ(read.material().tint, Vec3d(0.5, 1, 1));
    // exp(-2 sigma) is the colour after 2.
    EXPECT_EQ(read.material().sigma_a.x, 0);
    EXPECT_NEAR(std::exp(-2 * read.material().sigma_a.y), 0.5, 1e-15);
    EXPECT_NEAR(std::exp(-2 * read.material().sigma_a.z), 0.25, 1e-15);
    const Gltf thin(
        with_tetrahedron(Json::parse(R"({"pbrMetallicRoughness": {"metallicFactor": 0, "roughnessFactor": 0.5},
        "extensions": {"KHR_materials_transmission": {"transmissionFactor": 1}}})")));
    EXPECT_EQ(thin.material().type, MaterialType::rough_dielectric);
    EXPECT_EQ(thin.material().roughness, 0.5);
    EXPECT_EQ(thin.material().ior, 1.5);
    ASSERT_EQ(thin.warnings().size(), 2u);
    EXPECT_NE(thin.warnings()[0].find("thin wall"), std::string::npos);
    Json part = Json::parse(R"({"pbrMetallicRoughness": {"metallicFactor": 0.25, "roughnessFactor": 0.5},
        "extensions": {"KHR_materials_transmission": {"transmissionFactor": 0.5},
                       "KHR_materials_volume": {"thicknessFactor": 1}}})");
    const Gltf mixed(with_tetrahedron(part));
    EXPECT_EQ(mixed.problems(), Lines());
    EXPECT_EQ(mixed.material().type, MaterialType::principled);
    EXPECT_EQ(mixed.material().metallic, 0.25);
    EXPECT_EQ(mixed.material().transmission, 0.5);
    EXPECT_EQ(mixed.warnings()[0], "f: /materials/0" + other_formulas);
    part["extensions"]["KHR_materials_volume"]["attenuationDistance"] = 1;
    EXPECT_EQ(Gltf(with_tetrahedron(part)).problems(),
              Lines{"f: found /materials/0/extensions/KHR_materials_volume: light that is absorbed, allowed: none, or "
                    "transmissionFactor 1 and metallicFactor 0"});
    part["emissiveFactor"] = {1, 1, 1};
    EXPECT_EQ(Gltf(with_tetrahedron(part)).problems(),
              Lines{"f: found /materials/0/extensions/KHR_materials_transmission/transmissionFactor: 0.5, allowed: 0 "
                    "with emission"});
}

const std::string tiles = test::in_source("scenes/textures/tiles.png");

// The triangle of document() with v down, as glTF has it, and an image for its base colour.
Json document_with_image(const Json& image) {
    Json json = document();
    const std::string bytes = buffer + std::string(2, '\0') + bytes_of<float>({0, 1, 1, 1, 0, 0.25f});
    json["buffers"][0] = {{"byteLength", 68}, {"uri", "data:application/octet-stream;base64," + base64(bytes)}};
    json["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", 44}, {"byteLength", 24}});
    json["accessors"].push_back({{"bufferView", 2}, {"componentType", 5126}, {"count", 3}, {"type", "VEC2"}});
    json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = 2;
    json["materials"][0] = Json::parse(R"({"name": "tiles", "pbrMetallicRoughness": {"baseColorTexture": {"index": 0},
        "metallicFactor": 0}, "extensions": {"KHR_materials_specular": {"specularFactor": 0}}})");
    json["textures"] = Json::array({Json{{"source", 0}}});
    json["images"] = Json::array({image});
    return json;
}

// Whatever way a file has its image, the texels are those of the file, and the corners lie where they did, with v up.
TEST_F(ImportGltfTest, TheBaseColoursImage) {
    const std::string content = content_of(tiles);
    const Json in_text = {{"uri", "data:image/png;base64," + base64(content)}};
    for (const Json& image : {Json{{"uri", tiles}}, in_text}) {
        const Gltf read(document_with_image(image));
        ASSERT_EQ(read.problems(), Lines());
        const bool is_beside = read.result.images.empty();
        EXPECT_EQ(is_beside, image != in_text);
        if (!is_beside) {
            EXPECT_EQ(read.result.images[0].file, "back_image_0.png");
            EXPECT_EQ(read.result.images[0].content, content);
        }
        ASSERT_EQ(read.scene.materials.size(), 1u);
        ASSERT_NE(read.scene.materials[0].texture, nullptr);
        EXPECT_EQ(read.scene.materials[0].texture->image.texels, read_texture_image(tiles).texels);
        const auto& corners = read.scene.meshes.at(0)->coordinates;
        ASSERT_EQ(corners.size(), 1u);
        const Triangle<float>& triangle = read.scene.meshes[0]->triangles[0];
        for (int i = 0; i < 3; ++i) {
            const Vec3<float> at = i == 0 ? triangle.a : i == 1 ? triangle.b : triangle.c;
            EXPECT_EQ(corners[0].u[i], at.x);
            EXPECT_EQ(corners[0].v[i], at.y == 2 ? 0.75f : 0.0f);
        }
    }
}

TEST_F(ImportGltfTest, AnImageInTheBuffer) {
    const std::string content = content_of(tiles);
    Json json = document_with_image({{"bufferView", 3}, {"mimeType", "image/png"}});
    json["buffers"].push_back(
        {{"byteLength", content.size()}, {"uri", "data:application/octet-stream;base64," + base64(content)}});
    json["bufferViews"].push_back({{"buffer", 1}, {"byteOffset", 0}, {"byteLength", content.size()}});
    const Gltf read(json);
    ASSERT_EQ(read.problems(), Lines());
    ASSERT_EQ(read.result.images.size(), 1u);
    EXPECT_EQ(read.result.images[0].content, content);
    EXPECT_EQ(read.notes().back(), "f: /images/0 is written as back_image_0.png");
    json["bufferViews"][3]["byteLength"] = content.size() + 1;
    EXPECT_EQ(Gltf(json).problems().size(), 1u);
}

TEST_F(ImportGltfTest, ImagesThatCannotBeShownAreRefused) {
    const auto problem = [](const Json& json) {
        const Gltf read(json);
        EXPECT_EQ(read.problems().size(), 1u) << fmt::format("{}", fmt::join(read.problems(), "\n"));
        return read.problems().empty() ? "" : read.problems()[0];
    };
    const std::string texture = "f: found /materials/0/pbrMetallicRoughness/baseColorTexture: texture 0, allowed: ";
    const Json good = document_with_image({{"uri", tiles}});
    EXPECT_TRUE(problem(document_with_image({{"uri", "missing.png"}}))
                    .starts_with(texture + "an image that can be read (in/missing.png"));
    EXPECT_NE(problem(document_with_image({{"uri", "a%20b.webp"}}))
                  .find("in/a b.webp: file name: found the ending \".webp\""),
              std::string::npos);
    Json changed = good;
    changed["samplers"] = Json::array({Json{{"wrapS", 33071}}});
    changed["textures"][0]["sampler"] = 0;
    EXPECT_EQ(problem(changed), texture + "wrapS and wrapT 10497 of /samplers/0: images repeat here");
    changed["samplers"][0] = {{"magFilter", 9728}, {"wrapS", 10497}};
    EXPECT_EQ(problem(changed), texture + "magFilter 9729 of /samplers/0: texels are blended here");
    changed["samplers"][0] = {{"minFilter", 9987}};
    EXPECT_EQ(Gltf(changed).problems(), Lines());
    changed = good;
    changed["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] = {1, 0.5, 1, 1};
    EXPECT_EQ(problem(changed),
              "f: found /materials/0/pbrMetallicRoughness/baseColorFactor: [1, 0.5, 1], allowed: [1, 1, 1] with "
              "baseColorTexture: scene files do not multiply images");
    changed = good;
    changed["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["texCoord"] = 1;
    EXPECT_EQ(problem(changed),
              "f: found /materials/0/pbrMetallicRoughness/baseColorTexture/texCoord: 1, allowed: 0, for TEXCOORD_0");
    changed = good;
    changed["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["extensions"]["KHR_texture_transform"]
           ["offset"] = Json::array({0.5, 0});
    EXPECT_EQ(problem(changed), texture + "a texture without KHR_texture_transform");
    changed = good;
    changed["meshes"][0]["primitives"][0]["attributes"].erase("TEXCOORD_0");
    EXPECT_EQ(problem(changed),
              "f: found /meshes/0/primitives/0/attributes: no TEXCOORD_0 that can be read, allowed: one for each "
              "vertex, since "
              "tiles is an image");
    changed = good;
    changed["materials"][0]["normalTexture"] = {{"index", 0}, {"texCoord", 1}};
    EXPECT_EQ(problem(changed), "f: found /materials/0/normalTexture/texCoord: 1, allowed: 0, for TEXCOORD_0");
    changed["materials"][0]["normalTexture"] = {{"index", 5}};
    EXPECT_EQ(problem(changed), "f: found /materials/0/normalTexture: texture 5, allowed: a texture from 0 to 0");
    changed = good;
    changed["materials"][0]["emissiveTexture"]["index"] = 0;
    EXPECT_EQ(problem(changed),
              "f: found /materials/0/emissiveTexture: texture 0, allowed: no texture: of a material baseColorTexture "
              "and normalTexture are read");
    changed = good;
    changed["materials"][0]["extensions"] = {{"KHR_materials_transmission", {{"transmissionFactor", 1}}}};
    EXPECT_EQ(problem(changed), texture + "no texture on glass");
}

// The triangle of document_with_image with these normals of its corners.
Json document_with_normals(const std::vector<float>& normals) {
    Json json = document_with_image({{"uri", tiles}});
    const std::string bytes = bytes_of<float>(normals);
    json["buffers"].push_back(
        {{"byteLength", bytes.size()}, {"uri", "data:application/octet-stream;base64," + base64(bytes)}});
    json["bufferViews"].push_back({{"buffer", 1}, {"byteOffset", 0}, {"byteLength", bytes.size()}});
    json["accessors"].push_back({{"bufferView", 3}, {"componentType", 5126}, {"count", 3}, {"type", "VEC3"}});
    json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = 3;
    return json;
}

TEST_F(ImportGltfTest, NormalsOfVertices) {
    const Gltf read(document_with_normals({1, 0, 1, 0, 0, 2, 0, 1, 1}));
    ASSERT_EQ(read.problems(), Lines());
    ASSERT_EQ(read.scene.objects.size(), 1u);
    EXPECT_TRUE(read.scene.objects[0].shading_normals);
    EXPECT_TRUE(contains(features_of(read.scene), Feature::shading_normals));
    ASSERT_EQ(read.scene.meshes.at(0)->normals.size(), 1u);
    // The least corner stands first in the file too.
    const CornerNormals& corners = read.scene.meshes[0]->normals[0];
    const float half = static_cast<float>(std::sqrt(0.5));
    EXPECT_EQ(Vec3<float>(corners.of[0][0], corners.of[0][1], corners.of[0][2]), Vec3<float>(half, 0, half));
    for (int i = 1; i < 3; ++i) {
        const Triangle<float>& t = read.scene.meshes[0]->triangles[0];
        const bool is_second = (i == 1 ? t.b : t.c).y == 0;
        EXPECT_EQ(Vec3<float>(corners.of[i][0], corners.of[i][1], corners.of[i][2]),
                  is_second ? Vec3<float>(0, 0, 1) : Vec3<float>(0, half, half));
    }
    // What is no direction leaves the triangles flat.
    for (const float bad : {0.0f, std::numeric_limits<float>::quiet_NaN()}) {
        const Gltf flat(document_with_normals({1, 0, 1, bad, bad, bad, 0, 1, 1}));
        EXPECT_EQ(flat.problems(), Lines());
        EXPECT_FALSE(flat.scene.objects.at(0).shading_normals);
        EXPECT_EQ(
            flat.warnings().at(0),
            "f: /meshes/0/primitives/0/attributes/NORMAL has one that is no direction: the triangles are flat here");
    }
}

// A node that mirrors gets a mesh of its own, whose normals go with it.
TEST_F(ImportGltfTest, NormalsOfAMeshThatIsMirrored) {
    Json json = document_with_normals({1, 0, 1, 0, 0, 2, 0, 1, 1});
    for (Json& node : json["nodes"]) {
        if (node.contains("mesh")) {
            node["scale"] = {-1, 1, 1};
        }
    }
    const Gltf read(json);
    ASSERT_EQ(read.problems(), Lines());
    ASSERT_EQ(read.scene.objects.size(), 1u);
    EXPECT_TRUE(read.scene.objects[0].shading_normals);
    bool has_leaning = false;
    for (const CornerNormals& corners : read.scene.meshes.at(read.scene.objects[0].mesh)->normals) {
        for (const auto& normal : corners.of) {
            has_leaning = has_leaning || (normal[0] < -0.7f && std::abs(normal[2]) > 0.7f);
            EXPECT_LE(normal[0], 0);
        }
    }
    EXPECT_TRUE(has_leaning);
}

TEST_F(ImportGltfTest, ANormalTexture) {
    Json json = document_with_image({{"uri", test::in_source("scenes/textures/studs.png")}});
    json["materials"][0]["pbrMetallicRoughness"].erase("baseColorTexture");
    for (const double scale : {1.0, 0.25}) {
        json["materials"][0]["normalTexture"] = {{"index", 0}, {"scale", scale}};
        const Gltf read(json);
        ASSERT_EQ(read.problems(), Lines());
        const SceneMaterial& material = read.scene.materials.at(0);
        ASSERT_NE(material.normal_texture, nullptr);
        EXPECT_EQ(material.texture, nullptr);
        EXPECT_EQ(material.normal_scale, scale);
        EXPECT_EQ(material.normal_texture->image.texels,
                  read_texture_image(test::in_source("scenes/textures/studs.png"), TexelMeaning::normal).texels);
    }
    // An image on glass needs texture coordinates too.
    json["materials"][0]["extensions"] = {{"KHR_materials_transmission", {{"transmissionFactor", 1}}}};
    json["meshes"][0]["primitives"][0]["attributes"].erase("TEXCOORD_0");
    EXPECT_EQ(Gltf(json).problems().size(), 1u);  // no coordinates
}

TEST_F(ImportGltfTest, EverythingThatIsNotReadIsListedAtOnce) {
    Json json = document();
    json["extensionsUsed"] = {"KHR_lights_punctual", "KHR_draco_mesh_compression"};
    json["extensionsRequired"] = {"KHR_draco_mesh_compression"};
    json["extensions"]["KHR_lights_punctual"]["lights"] = Json::array({Json{{"type", "point"}}});
    json["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"] = 0;
    json["materials"][0] = Json::parse(R"({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0},
        "metallicFactor": 0, "baseColorFactor": [1, 1, 1, 0.5]}, "alphaMode": "BLEND",
        "extensions": {"KHR_materials_clearcoat": {"clearcoatFactor": 1}}})");
    json["textures"] = Json::array({Json{{"source", 0}}});
    json["images"] = Json::array({Json{{"uri", "missing.png"}}});
    json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = 0;
    const Gltf read(json);
    EXPECT_EQ(read.result.json, "");
    Lines starts;
    for (const std::string& problem : read.problems()) {
        starts.push_back(problem.substr(0, problem.find(", allowed")));
    }
    EXPECT_EQ(starts, (Lines{"f: found /extensionsRequired/0: KHR_draco_mesh_compression",
                             "f: found /extensions/KHR_lights_punctual/lights/0: point light",
                             "f: found /meshes/0/primitives/0/attributes/COLOR_0: colours of vertices",
                             "f: found /materials/0/pbrMetallicRoughness/baseColorTexture: texture 0",
                             "f: found /materials/0/extensions/KHR_materials_clearcoat: an extension",
                             "f: found /materials/0/alphaMode: BLEND with alpha 0.5"}));
}

TEST_F(ImportGltfTest, WithoutACameraOneIsPutBeforeAll) {
    Json json = document();
    json["nodes"][0].erase("camera");
    const Gltf read(json);
    EXPECT_EQ(read.problems(), Lines());
    ASSERT_EQ(read.warnings().size(), 1u);
    const SceneCamera& camera = read.scene.camera;
    EXPECT_NEAR(camera.look_at.x, 0.5, 1e-6);
    EXPECT_NEAR(camera.look_at.y, 1, 1e-6);
    // A ball of radius sqrt(5) / 2 fits into 45 degrees.
    EXPECT_NEAR(camera.eye.z, std::sqrt(1.25) / std::sin(22.5 * (pi<double> / 180)), 1e-5);
    EXPECT_EQ(camera.vertical_fov_degrees, 45);
    EXPECT_EQ(camera.width, 800u);
}

TEST_F(ImportGltfTest, BuffersMayLieBesideIt) {
    const TemporaryFolder folder;
    Json json = document();
    json["buffers"][0]["uri"] = "data.bin";
    write_text(folder.file("data.bin"), buffer);
    const auto import = [&] {
        return import_gltf(
            {.text = json.dump(), .file = folder.file("s.gltf"), .out = folder.file("s.json"), .name = "n"});
    };
    EXPECT_NE(import().json, "");
    std::filesystem::remove(folder.file("data.bin"));
    const ImportResult missing = import();
    EXPECT_EQ(missing.json, "");
    EXPECT_EQ(missing.problems.count(), 1u);
}

TEST_F(ImportGltfTest, WhatIsNoGltfIsOneLine) {
    for (const std::string text :
         {"", "{}", "glTF", "{\"asset\": {\"version\": \"2.0\"}, \"nodes\": [{\"children\": [0]}]}"}) {
        EXPECT_GE(Gltf(text).problems().size(), 1u) << text;
    }
    EXPECT_TRUE(is_like_gltf("glTF\x02"));
    EXPECT_STREQ(import_format_of({.text = "", .file = "a.gltf", .out = "", .name = ""}).name, "glTF 2");
}

}  // namespace
}  // namespace pt::test
