// Mesh files: what is read of good ones, and the one line that each fault of a broken one gets.
#include "harness/mesh/read_mesh.h"

#include <limits>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "harness/failure.h"
#include "tests/support/command.h"

namespace pt {
namespace {

// What reading it throws; empty where it is read.
template <class Parse>
std::string fault_of(const Parse& parse, const std::string& content) {
    try {
        (void)parse(content, "mesh");
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

std::string replaced(std::string text, const std::string& old, const std::string& with) {
    return text.replace(text.find(old), old.size(), with);
}

using Corners = std::array<std::array<float, 2>, 3>;

const std::string ascii_ply =
    "ply\nformat ascii 1.0\ncomment by hand\nelement vertex 4\nproperty float x\nproperty double y\nproperty float z\n"
    "property uchar red\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n"
    "0 0 0 255\n1 0 0 255\n1 1 0 255\n0 1 .5 255\n4 0 1 2 3\n3 0 0 2\n";

TEST(PlyTest, TextIsReadPolygonsAreFannedAndDegenerateFacesCounted) {
    const Mesh mesh = parse_ply(ascii_ply, "mesh");
    EXPECT_EQ(mesh.vertices, (std::vector<std::array<float, 3>>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0.5f}}));
    EXPECT_EQ(mesh.triangles, (std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}, {0, 2, 3}}));
    EXPECT_TRUE(mesh.normals.empty());
    EXPECT_EQ(mesh.degenerate_left_out, 1u);
}

TEST(PlyTest, BothByteOrdersAndNormalsAreRead) {
    const std::string header =
        "element vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty float nx\nproperty float ny\n"
        "property float nz\nelement face 1\nproperty list uchar uint vertex_index\nend_header\n";
    const auto file = [&](bool little) {
        std::string content =
            std::string("ply\r\nformat binary_") + (little ? "little" : "big") + "_endian 1.0\r\n" + header;
        const auto add = [&](std::uint32_t word) {
            for (int i = 0; i < 4; ++i) {
                content += static_cast<char>(word >> (little ? 8 * i : 24 - 8 * i));
            }
        };
        for (const std::uint32_t vertex : {0u, 1u, 2u}) {
            for (std::uint32_t i = 0; i < 6; ++i) {
                add(i == vertex || i == 5 ? 0x3fa00000u : 0u);  // 1.25
            }
        }
        content += '\3';
        add(0), add(1), add(2);
        return content;
    };
    for (const bool little : {true, false}) {
        const Mesh mesh = parse_ply(file(little), "mesh");
        EXPECT_EQ(mesh.vertices, (std::vector<std::array<float, 3>>{{1.25f, 0, 0}, {0, 1.25f, 0}, {0, 0, 1.25f}}));
        EXPECT_EQ(mesh.normals, (std::vector<std::array<float, 3>>(3, {0, 0, 1.25f})));
        EXPECT_EQ(mesh.triangles, (std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}}));
        EXPECT_EQ(fault_of(parse_ply, file(little).substr(0, file(little).size() - 1)),
                  "mesh: face 0: found the end of the file, allowed: all elements that the header declares");
    }
}

TEST(PlyTest, TextureCoordinatesAreReadByTheirNames) {
    const std::string plain =
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
        "property float s\nproperty float t\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n"
        "0 0 0 0 0\n1 0 0 1 0.25\n1 1 0 2 1\n0 1 .5 0 1\n3 0 1 0\n4 0 1 2 3\n";
    const std::vector<Corners> expected{{{{0, 0}, {1, 0.25f}, {2, 1}}}, {{{0, 0}, {2, 1}, {0, 1}}}};
    EXPECT_EQ(parse_ply(plain, "mesh").coordinates, expected);
    for (const auto& [u, v] : {std::pair{"float u\n", "float v\n"}, {"float texture_u\n", "float texture_v\n"}}) {
        EXPECT_EQ(parse_ply(replaced(replaced(plain, "float s\n", u), "float t\n", v), "mesh").coordinates, expected);
    }
    EXPECT_TRUE(parse_ply(replaced(plain, "float t\n", "float q\n"), "mesh").coordinates.empty());
    // Whoever shows no image has no use for them.
    EXPECT_TRUE(parse_ply(replaced(plain, "2 1\n", "nan 1\n"), "mesh").coordinates.empty());
    EXPECT_EQ(parse_ply(replaced(plain, "2 1\n", "nan 1\n"), "mesh").triangles.size(), 2u);
}

TEST(PlyTest, EachFaultHasItsLine) {
    const auto fault = [](const std::string& old, const std::string& with) {
        return fault_of(parse_ply, replaced(ascii_ply, old, with));
    };
    EXPECT_EQ(fault("4 0 1 2 3", "4 0 1 2 4"), "mesh: triangle 1: found vertex 4, allowed: 0 to 3");
    EXPECT_EQ(fault("4 0 1 2 3", "4 0 1 2 -1"),
              "mesh: face 0: found vertex -1, allowed: the number of a vertex, from 0");
    EXPECT_EQ(fault("4 0 1 2 3", "2 0 1"), "mesh: face 0: found 2 corners, allowed: at least 3");
    EXPECT_EQ(fault("1 1 0 255", "1 nan 0 255"),
              "mesh: vertex 2: found (1, nan, 0), allowed: finite numbers in single precision");
    EXPECT_EQ(fault("1 1 0 255", "1 1e39 0 255"),
              "mesh: vertex 2: found (1, inf, 0), allowed: finite numbers in single precision");
    EXPECT_EQ(fault("1 1 0 255", "1 1e-999 0 255"), "");
    EXPECT_EQ(fault("1 1 0 255", "1 x1 0 255"), "mesh: vertex 2: found \"x1\", allowed: a number");
    EXPECT_EQ(fault("3 0 0 2", "3 0 0"),
              "mesh: face 1: found the end of the file, allowed: all elements that the header declares");
    EXPECT_EQ(
        fault("4 0 1 2 3\n3 0 0 2", "3 0 0 3\n3 0 0 2"),
        "mesh: mesh: found 2 triangles without area and no other, allowed: at least one triangle that has an area");
    EXPECT_EQ(
        fault("vertex 4", "vertex 400000000"),
        "mesh: vertex 0: found 400000000 of them declared, and bytes for 7, allowed: a file as long as its header "
        "says");
    EXPECT_EQ(fault("property float z\n", ""), "mesh: header: found vertices without z, allowed: x, y and z");
    EXPECT_EQ(fault("vertex_indices", "corners"),
              "mesh: header: found faces without vertex_indices, allowed: a list of that name, or vertex_index");
    EXPECT_EQ(
        fault("ascii 1.0", "ascii 2.0"),
        "mesh: line 2: found format ascii 2.0, allowed: once: ascii, binary_little_endian or binary_big_endian, 1.0");
    EXPECT_EQ(fault("ply\n", "obj\n"),
              "mesh: line 1: found a file that does not begin with the line \"ply\", allowed: a PLY file");
    EXPECT_EQ(fault("end_header\n", ""),
              "mesh: line 11: found \"0 0 0 255\", allowed: format, element NAME COUNT, property TYPE NAME (after an "
              "element), comment or end_header");
}

const std::string quad_obj =
    "# by hand\nmtllib none.mtl\nv 0 0 0\nv 1 0 0 1\n  v 1 +1 0 .5 .5 .5\nv 0 1 .5\r\nvt 0 0\no quad\nf 1/1 2/1 3/1 "
    "4/1\n"
    "f -4 -4 -1\n";

TEST(ObjTest, PolygonsAreFannedAndDegenerateFacesCounted) {
    const Mesh mesh = parse_obj(quad_obj, "mesh");
    EXPECT_EQ(mesh.vertices, (std::vector<std::array<float, 3>>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0.5f}}));
    EXPECT_EQ(mesh.triangles, (std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}, {0, 2, 3}}));
    EXPECT_TRUE(mesh.normals.empty());
    EXPECT_EQ(mesh.degenerate_left_out, 1u);
}

TEST(ObjTest, FacesMayComeFirstAndLinesMayBeJoined) {
    const Mesh mesh = parse_obj("f 1 \\\n2 \\\n3\nv 0 0 0\nv 1 0 0\nv 0 1 0", "mesh");
    EXPECT_EQ(mesh.triangles, (std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}}));
    EXPECT_EQ(fault_of(parse_obj, "f 1 \\\n2 \\\n3\nv 0 0 0\nv 1 0 0\nv x 1 0"),
              "mesh: line 6: found \"v x 1 0\", allowed: 3 numbers");
}

TEST(ObjTest, AVertexWithTwoNormalsBecomesTwo) {
    const std::string points = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvn 0 0 1\nvn 1 0 0\n";
    const Mesh mesh = parse_obj(points + "f 1//1 2//1 3//1\nf 1//2 3/7/2 4//2\n", "mesh");
    EXPECT_EQ(mesh.vertices,
              (std::vector<std::array<float, 3>>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0}, {0, 1, 0}, {0, 0, 1}}));
    EXPECT_EQ(mesh.normals,
              (std::vector<std::array<float, 3>>{{0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {1, 0, 0}, {1, 0, 0}, {1, 0, 0}}));
    EXPECT_EQ(mesh.triangles, (std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}, {3, 4, 5}}));
    EXPECT_TRUE(parse_obj(points + "f 1//1 2//1 3//1\nf 1 3 4\n", "mesh").normals.empty());
    EXPECT_EQ(fault_of(parse_obj, points + "f 1//1 2//3 3//1\n"),
              "mesh: line 7: found normal 3, allowed: 1 to 2, or -1 to -2");
}

TEST(ObjTest, TextureCoordinatesAreReadWhereEveryCornerHasSome) {
    const std::string plain =
        "f 1/2 2/-1 3/3/1\nvt 0 0\n# the first face names what comes later\n"
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 .5\nvn 0 0 1\nvt .5 0.25 7\nvt 1\nf 1/1 3/3 4/-2\n";
    // -1 of a file without any so far is none.
    EXPECT_TRUE(parse_obj(plain, "mesh").coordinates.empty());
    const std::string good = replaced(plain, "2/-1", "2/1");
    EXPECT_EQ(parse_obj(good, "mesh").coordinates,
              (std::vector<Corners>{{{{0.5f, 0.25f}, {0, 0}, {1, 0}}}, {{{0, 0}, {1, 0}, {0.5f, 0.25f}}}}));
    EXPECT_EQ(parse_obj(good, "mesh").vertices.size(), 4u);
    for (const auto& [old, with] : {std::pair{"1/2 ", "1 "},
                                    {"1/2 ", "1/4 "},
                                    {"1/2 ", "1/x "},
                                    {"vt 1\n", "vt one\n"},
                                    {"vt 1\n", "vt nan\n"}}) {
        const Mesh mesh = parse_obj(replaced(good, old, with), "mesh");
        EXPECT_TRUE(mesh.coordinates.empty()) << with;
        EXPECT_EQ(mesh.triangles.size(), 2u) << with;
    }
    // What is left out takes its coordinates along.
    EXPECT_EQ(parse_obj("f 1/1 1/2 3/3\n" + good, "mesh").coordinates, parse_obj(good, "mesh").coordinates);
}

TEST(ObjTest, EachFaultHasItsLine) {
    const auto fault = [](const std::string& old, const std::string& with) {
        return fault_of(parse_obj, replaced(quad_obj, old, with));
    };
    EXPECT_EQ(fault("v 0 1 .5", "v 0 1"), "mesh: line 6: found \"v 0 1\", allowed: 3 numbers");
    EXPECT_EQ(fault("v 0 1 .5", "v 0 x .5"), "mesh: line 6: found \"v 0 x .5\", allowed: 3 numbers");
    EXPECT_EQ(fault("v 0 1 .5", "v 0 nan .5"),
              "mesh: vertex 3: found (0, nan, 0.5), allowed: finite numbers in single precision");
    EXPECT_EQ(fault("v 0 1 .5", "v 0 -1e99 .5"),
              "mesh: vertex 3: found (0, -inf, 0.5), allowed: finite numbers in single precision");
    EXPECT_EQ(fault("4/1", "5/1"), "mesh: line 9: found vertex 5, allowed: 1 to 4, or -1 to -4");
    EXPECT_EQ(fault("4/1", "0/1"),
              "mesh: line 9: found \"0/1\", allowed: V, V/T, V//N or V/T/N, whole numbers from 1, or from -1 backward");
    EXPECT_EQ(fault("-4 -4 -1", "-4 -5 -1"),
              "mesh: line 10: found \"-5\", allowed: -1 to -4: so many there are before this line");
    EXPECT_EQ(fault("-4 -4 -1", "1 2"), "mesh: line 10: found \"f 1 2\", allowed: a face with at least 3 corners");
    EXPECT_EQ(
        fault("f 1/1 2/1 3/1 4/1\n", ""),
        "mesh: mesh: found 1 triangle without area and no other, allowed: at least one triangle that has an area");
    EXPECT_EQ(fault_of(parse_obj, "v 0 0 0\n"),
              "mesh: mesh: found no triangles, allowed: at least one triangle that has an area");
}

std::string glb_of(nlohmann::json json, std::string binary) {
    std::string text = json.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    binary.resize((binary.size() + 3) / 4 * 4, '\0');
    std::string content = "glTF";
    const auto add = [&](std::size_t word) {
        for (int i = 0; i < 4; ++i) {
            content += static_cast<char>(word >> (8 * i));
        }
    };
    add(2), add(12 + 8 + text.size() + 8 + binary.size());
    add(text.size());
    content += "JSON" + text;
    add(binary.size());
    return content + std::string("BIN\0", 4) + binary;
}

template <class T>
std::string bytes_of_all(const std::vector<T>& values) {
    return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

// A quad of two triangles with normals along z.
struct GlbQuad {
    nlohmann::json json = nlohmann::json::parse(R"({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 1}, "indices": 2}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
                      {"bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC3"},
                      {"bufferView": 2, "componentType": 5123, "count": 6, "type": "SCALAR"}],
        "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 48},
                        {"buffer": 0, "byteOffset": 96, "byteLength": 12}],
        "buffers": [{"byteLength": 108}]})");
    std::vector<float> positions{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0.5f}, normals{0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1};
    std::vector<std::uint16_t> indices{0, 1, 2, 0, 2, 3};

    std::string content() const {
        return glb_of(json, bytes_of_all(positions) + bytes_of_all(normals) + bytes_of_all(indices));
    }
    Mesh mesh() const { return parse_glb(content(), "mesh"); }
    std::string fault() const { return fault_of(parse_glb, content()); }
};

class GlbTest : public testing::Test {
protected:
    void SetUp() override {
        if (!reads_glb()) {
            EXPECT_EQ(GlbQuad().fault(),
                      "mesh: this build has no reader for .glb: install libtinygltf-dev and build again");
            GTEST_SKIP() << "built without tinygltf";
        }
    }
};

TEST_F(GlbTest, TrianglesAndNormalsAreRead) {
    const Mesh mesh = GlbQuad().mesh();
    EXPECT_EQ(mesh.vertices, (std::vector<std::array<float, 3>>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0.5f}}));
    EXPECT_EQ(mesh.normals, (std::vector<std::array<float, 3>>(4, {0, 0, 1})));
    EXPECT_EQ(mesh.triangles, (std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}, {0, 2, 3}}));
}

TEST_F(GlbTest, NodesMoveTheirMeshesAndAMirrorTurnsTheCorners) {
    GlbQuad quad;
    // A quarter turn about z of the children: one mirrored in y, one moved by a matrix.
    quad.json["nodes"] = nlohmann::json::parse(
        R"([{"children": [1, 2], "translation": [10, 0, 0], "rotation": [0, 0, 0.7071067811865476, 0.7071067811865476]},
            {"mesh": 0, "scale": [1, -2, 1]},
            {"mesh": 0, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 7, 1]}])");
    const Mesh mesh = quad.mesh();
    ASSERT_EQ(mesh.vertices.size(), 8u);
    const std::array<float, 3> expected[] = {{10, 0, 0}, {10, 1, 0}, {12, 1, 0}, {12, 0, 0.5f},
                                             {10, 0, 7}, {10, 1, 7}, {9, 1, 7},  {9, 0, 7.5f}};
    for (std::size_t i = 0; i < 8; ++i) {
        for (int k = 0; k < 3; ++k) {
            EXPECT_NEAR(mesh.vertices[i][k], expected[i][k], 1e-6) << i;
        }
        EXPECT_GT(mesh.normals[i][2], 0.0f) << i;  // mirrored in y, z stays up
    }
    EXPECT_EQ(mesh.triangles, (std::vector<std::array<std::uint32_t, 3>>{{0, 2, 1}, {0, 3, 2}, {4, 5, 6}, {4, 6, 7}}));
}

// v goes down from the image's top in glTF, and up here.
TEST_F(GlbTest, TextureCoordinatesAreRead) {
    GlbQuad quad;
    EXPECT_TRUE(quad.mesh().coordinates.empty());
    quad.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = 3;
    quad.json["accessors"].push_back({{"bufferView", 3}, {"componentType", 5126}, {"count", 4}, {"type", "VEC2"}});
    quad.json["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", 108}, {"byteLength", 32}});
    quad.json["buffers"][0]["byteLength"] = 140;
    const auto read = [&](const std::string& coordinates) {
        return parse_glb(glb_of(quad.json, bytes_of_all(quad.positions) + bytes_of_all(quad.normals) +
                                               bytes_of_all(quad.indices) + coordinates),
                         "mesh");
    };
    const std::string floats = bytes_of_all(std::vector<float>{0, 1, 1, 1, 1, 0.25f, -0.5f, 0});
    EXPECT_EQ(read(floats).coordinates,
              (std::vector<Corners>{{{{0, 0}, {1, 0}, {1, 0.75f}}}, {{{0, 0}, {1, 0.75f}, {-0.5f, 1}}}}));
    nlohmann::json& accessor = quad.json["accessors"][3];
    accessor["componentType"] = 5123;
    accessor["normalized"] = true;
    const std::string shorts = bytes_of_all(std::vector<std::uint16_t>{0, 65535, 65535, 65535, 65535, 0, 0, 0});
    EXPECT_EQ(read(shorts + shorts).coordinates,
              (std::vector<Corners>{{{{0, 0}, {1, 0}, {1, 1}}}, {{{0, 0}, {1, 1}, {0, 1}}}}));
    // What cannot be read is not there, as before.
    for (const auto& [key, value] : std::initializer_list<std::pair<const char*, nlohmann::json>>{
             {"componentType", 5125}, {"type", "VEC3"}, {"count", 3}, {"count", 400}, {"bufferView", 9}}) {
        nlohmann::json& spoilt = quad.json["accessors"][3];
        const nlohmann::json kept = spoilt;
        spoilt[key] = value;
        EXPECT_TRUE(read(floats).coordinates.empty()) << key;
        EXPECT_EQ(read(floats).triangles.size(), 2u) << key;
        spoilt = kept;
    }
}

TEST_F(GlbTest, StripsAndFansAreTriangles) {
    GlbQuad quad;
    quad.json["accessors"][2]["count"] = 4;
    quad.json["meshes"][0]["primitives"][0]["mode"] = 5;
    quad.indices = {0, 1, 3, 2, 0, 0};
    EXPECT_EQ(quad.mesh().triangles, (std::vector<std::array<std::uint32_t, 3>>{{0, 1, 3}, {1, 2, 3}}));
    quad.json["meshes"][0]["primitives"][0]["mode"] = 6;
    quad.indices = {0, 1, 2, 3, 0, 0};
    EXPECT_EQ(quad.mesh().triangles, (std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}, {0, 2, 3}}));
    quad.json["meshes"][0]["primitives"][0].erase("indices");
    EXPECT_EQ(quad.mesh().triangles, (std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}, {0, 2, 3}}));
}

TEST_F(GlbTest, WhatIsNotReadIsTold) {
    const auto warnings = [](const std::string& nodes) {
        GlbQuad quad;
        quad.json["nodes"] = nlohmann::json::parse(nodes);
        quad.json["meshes"][0]["weights"] = {0.5};
        return quad.mesh().warnings.messages();
    };
    using Lines = std::vector<std::string>;
    EXPECT_EQ(warnings(R"([{"mesh": 0, "weights": [0]}])"), Lines());
    EXPECT_EQ(warnings(R"([{"mesh": 0}])"),
              Lines{"node 0: its weights of morph targets are passed over: the mesh has its own shape"});
    EXPECT_EQ(warnings(R"([{"mesh": 0, "weights": [0], "skin": 0}])"),
              Lines{"node 0: its skin is passed over: the mesh is placed as a mesh without one, and not bent"});
    EXPECT_EQ(warnings(R"([{"mesh": 0, "weights": [0], "rotation": [0, 0, 0, 0]}])"),
              Lines{"node 0: its rotation is (0, 0, 0, 0), which is none: it turns nothing"});
    EXPECT_EQ(warnings(R"([{"mesh": 0, "weights": [0], "extensions": {"EXT_mesh_gpu_instancing": {}}}])"),
              Lines{"node 0: its extension EXT_mesh_gpu_instancing is passed over"});
    GlbQuad lines;
    lines.json["meshes"][0]["primitives"].push_back({{"attributes", {{"POSITION", 0}}}, {"mode", 1}});
    EXPECT_EQ(lines.mesh().warnings.messages(),
              Lines{"mesh 0, primitive 1: it is passed over: points, lines, or no positions"});
}

TEST_F(GlbTest, ARotationIsMadeOfLengthOne) {
    GlbQuad quad;
    quad.json["nodes"][0]["rotation"] = {0, 0, 3, 3};  // a quarter turn about z
    const Mesh mesh = quad.mesh();
    const std::array<float, 3> expected[] = {{0, 0, 0}, {0, 1, 0}, {-1, 1, 0}, {-1, 0, 0.5f}};
    for (std::size_t i = 0; i < 4; ++i) {
        for (int k = 0; k < 3; ++k) {
            EXPECT_NEAR(mesh.vertices[i][k], expected[i][k], 1e-6) << i;
        }
    }
}

TEST_F(GlbTest, AScaleOfZeroHidesWhatHangsOnIt) {
    for (const std::string hidden : {R"("scale": [0, 0, 0])", R"("matrix": [0,0,0,0, 0,0,0,0, 0,0,0,0, 1,2,3,1])"}) {
        GlbQuad quad;
        quad.json["scenes"][0]["nodes"] = {0, 1};
        quad.json["nodes"] = nlohmann::json::parse(R"([{"mesh": 0}, {)" + hidden +
                                                   R"(, "children": [2]}, {"mesh": 0, "translation": [5, 0, 0]}])");
        EXPECT_EQ(quad.mesh().vertices.size(), 4u);
        EXPECT_EQ(quad.mesh().degenerate_left_out, 0u);
        EXPECT_EQ(quad.mesh().warnings.messages(),
                  std::vector<std::string>{"node 1: its scale is 0, which hides it and what hangs on it: left out"});
    }
}

// A node's place is in double precision, what it places in single.
TEST_F(GlbTest, ANodeFarOffIsTold) {
    GlbQuad quad;
    quad.json["nodes"][0]["translation"] = {500000.123, 4649776.42, 0};
    const std::vector<std::string> warnings = quad.mesh().warnings.messages();
    ASSERT_EQ(warnings.size(), 1u);
    EXPECT_TRUE(
        warnings[0].starts_with("vertex 0, where its node places it: coordinates with more digits than single "
                                "precision has: vertices are moved by up to 0."))
        << warnings[0];
}

TEST_F(GlbTest, AGltfHasItsDataBesideIt) {
    const test::TemporaryFolder folder;
    GlbQuad quad;
    const Mesh binary = quad.mesh();
    quad.json["buffers"][0]["uri"] = "quad.bin";
    test::write_text(folder.file("quad.gltf"), quad.json.dump());
    EXPECT_THROW(read_mesh(folder.file("quad.gltf")), InputError);  // nor is its data there
    test::write_text(folder.file("quad.bin"),
                     bytes_of_all(quad.positions) + bytes_of_all(quad.normals) + bytes_of_all(quad.indices));
    const Mesh beside = read_mesh(folder.file("quad.gltf"));
    EXPECT_EQ(beside.vertices, binary.vertices);
    EXPECT_EQ(beside.normals, binary.normals);
    EXPECT_EQ(beside.triangles, binary.triangles);
}

TEST_F(GlbTest, EachFaultHasItsLine) {
    const auto fault = [](const auto& change) {
        GlbQuad quad;
        change(quad);
        return quad.fault();
    };
    EXPECT_EQ(fault([](GlbQuad& quad) { quad.indices[5] = 4; }),
              "mesh: mesh 0, primitive 0: found vertex 4, allowed: 0 to 3");
    EXPECT_EQ(fault([](GlbQuad& quad) { quad.positions[4] = std::numeric_limits<float>::quiet_NaN(); }),
              "mesh: vertex 1: found (nan, nan, nan), allowed: finite numbers in single precision");
    EXPECT_EQ(
        fault([](GlbQuad& quad) { quad.json["accessors"][0]["count"] = 5; }),
        "mesh: accessor 0: found 5 elements of 12 bytes each 12 bytes from byte 0 on, allowed: at least one, within "
        "its bufferView (48 bytes) and buffer (108 bytes)");
    EXPECT_EQ(
        fault([](GlbQuad& quad) { quad.json["bufferViews"][2]["byteLength"] = 13; }),
        "mesh: accessor 2: found 6 elements of 2 bytes each 2 bytes from byte 0 on, allowed: at least one, within "
        "its bufferView (13 bytes) and buffer (108 bytes)");
    EXPECT_EQ(fault([](GlbQuad& quad) { quad.json["accessors"][2]["bufferView"] = 3; }),
              "mesh: file: found accessor[2] invalid bufferView, allowed: binary glTF 2.0 with its data in it");
    EXPECT_EQ(fault([](GlbQuad& quad) { quad.json["accessors"][0].erase("bufferView"); }),
              "mesh: accessor 0: found no bufferView, so that all its numbers are 0, allowed: one with a bufferView");
    EXPECT_EQ(fault([](GlbQuad& quad) { quad.json["asset"]["minVersion"] = "2.1"; }),
              "mesh: asset.minVersion: found \"2.1\", allowed: 2.0");
    EXPECT_EQ(fault([](GlbQuad& quad) { quad.json["asset"]["version"] = "3.0"; }),
              "mesh: asset.version: found \"3.0\", allowed: 2.0, or a later 2.x");
    EXPECT_EQ(fault([](GlbQuad& quad) { quad.json["asset"] = {{"version", "2.1"}, {"minVersion", "2.0"}}; }), "");
    EXPECT_EQ(fault([](GlbQuad& quad) { quad.json["accessors"][0]["componentType"] = 5123; }),
              "mesh: accessor 0: found component type 5123, allowed: float (5126)");
    EXPECT_EQ(fault([](GlbQuad& quad) { quad.json["nodes"][0]["children"] = {0}; }),
              "mesh: node 0: found nodes within nodes without end, allowed: at most 64 levels and 2^20 nodes");
    EXPECT_EQ(fault([](GlbQuad& quad) { quad.json["extensionsRequired"] = {"KHR_draco_mesh_compression"}; }),
              "mesh: extensionsRequired: found \"KHR_draco_mesh_compression\", allowed: none");
    EXPECT_EQ(fault([](GlbQuad& quad) {
                  quad.json["buffers"][0] = {{"byteLength", 108}, {"uri", "other.bin"}};
              }).substr(0, 12),
              "mesh: file: ");
    EXPECT_EQ(fault_of(parse_glb, GlbQuad().content().substr(0, 40)).substr(0, 12), "mesh: file: ");
    EXPECT_EQ(fault_of(parse_glb, "").substr(0, 12), "mesh: file: ");
}

// A chunk too long by 4 or 8 bytes, the size of its own header, is not seen by tinygltf.
TEST_F(GlbTest, ABinaryChunkThatIsLongerThanItsFileIsRefused) {
    const std::string content = GlbQuad().content();
    const std::size_t size_at = content.size() - 108 - 8;
    ASSERT_EQ(content.substr(size_at, 8), std::string("\x6c\0\0\0BIN\0", 8));
    const auto fault = [&](int size) {
        std::string spoilt = content;
        spoilt[size_at] = static_cast<char>(size);
        return fault_of(parse_glb, spoilt);
    };
    EXPECT_EQ(fault(108), "");
    for (const int size : {112, 116, 120}) {
        EXPECT_EQ(fault(size),
                  fmt::format("mesh: chunk BIN: found {} bytes, allowed: at most 108, where the file ends", size));
    }
}

TEST(ReadMeshTest, AFileThatIsMissingOrOfAnotherKindIsRefused) {
    const test::TemporaryFolder folder;
    const auto fault = [&](const std::string& name) {
        return fault_of([&](const std::string& file, const std::string&) { return read_mesh(folder.file(file)); },
                        name);
    };
    test::write_text(folder.file("a.ply"), ascii_ply);
    test::write_text(folder.file("b.PLY"), ascii_ply);
    test::write_text(folder.file("a.stl"), "solid");
    EXPECT_EQ(fault("a.ply"), "");
    EXPECT_EQ(fault("b.PLY"), "");
    EXPECT_NE(fault("missing.ply").find("missing.ply"), std::string::npos);
    EXPECT_NE(fault("a.stl").find("found the ending \".stl\", allowed: "), std::string::npos) << fault("a.stl");
}

}  // namespace
}  // namespace pt
