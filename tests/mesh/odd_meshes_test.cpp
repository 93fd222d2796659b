// Mesh files that are easily misread: each is read right, or says in a warning what of it is not.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "harness/failure.h"
#include "harness/mesh/obj_materials.h"
#include "harness/mesh/read_mesh.h"

namespace pt {
namespace {

using Lines = std::vector<std::string>;
using Triangles = std::vector<std::array<std::uint32_t, 3>>;

const std::string square = "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\n";

Lines warnings_of(const std::string& obj) { return parse_obj(obj, "a").warnings.messages(); }

double area_of(const Mesh& mesh) {
    double twice = 0;
    for (const auto& [a, b, c] : mesh.triangles) {
        const auto &p = mesh.vertices[a], &q = mesh.vertices[b], &r = mesh.vertices[c];
        twice +=
            std::abs((double{q[0]} - p[0]) * (double{r[1]} - p[1]) - (double{q[1]} - p[1]) * (double{r[0]} - p[0]));
    }
    return twice / 2;
}

std::string ply_of(const std::string& vertices, int count, const std::string& faces,
                   const std::string& type = "float") {
    return fmt::format(
        "ply\nformat ascii 1.0\nelement vertex {}\nproperty {} x\nproperty {} y\nproperty {} z\nelement {}\nproperty "
        "list uchar int vertex_indices\nend_header\n{}",
        count, type, type, type, faces, vertices);
}

TEST(OddObjTest, ACommentEndsWithItsLine) {
    for (const std::string comment : {"# C:\\models\\", "  # C:\\models\\ ", "#\\", "g C:\\models\\", "o a\\",
                                      "usemtl C:\\models\\", "mtllib C:\\models\\"}) {
        const Mesh mesh = parse_obj(comment + "\n" + square + comment + "\nf 1 2 3\nf 1 3 4\n", "a");
        EXPECT_EQ(area_of(mesh), 4) << comment;
        EXPECT_EQ(mesh.warnings.messages(), Lines()) << comment;
    }
    EXPECT_EQ(area_of(parse_obj("v 0 0 0 # C:\\\nv 2 0 0\nv 2 2 0\nv 0 2 0\nf 1 2 \\\n3 4 # C:\\\nf 1 2 3\n", "a")), 6);
    EXPECT_EQ(area_of(parse_obj(square + "f 1 2 \\ \r\n3 4\n", "a")), 4);
}

TEST(OddObjTest, WhatIsPassedOverIsTold) {
    const std::string faces = square + "f 1 2 3\nf 1 3 4\n";
    EXPECT_EQ(warnings_of("g a b\no c\ns off\nmg 0\nusemtl d\nmtllib e\nbevel on\nusemap off\n\n# f\n" + faces),
              Lines());
    EXPECT_EQ(warnings_of(faces + "l 1 2\np 1\nl 3 4\n"),
              Lines{"line 7: p or l is passed over: points and lines have no area (and 2 more of these)"});
    EXPECT_EQ(warnings_of(faces + "cstype bspline\ndeg 3\ncurv 0 1 1 2\nend\n"),
              Lines{"line 7: a curve or a surface is passed over (from a keyword such as cstype, curv, surf or parm "
                    "on): only faces are read (and 3 more of these)"});
    EXPECT_EQ(warnings_of(faces + "call b.obj\nV 1 2 3\nV 1 2 3\n"),
              (Lines{"line 7: call is passed over: what it names is not read",
                     "line 8: \"V\" is passed over: no keyword of the format (and 1 more of these)"}));
    EXPECT_EQ(warnings_of(faces + "lod 2\n"),
              Lines{"line 7: lod is passed over: all levels of detail are read, one upon the other"});
    EXPECT_EQ(warnings_of(faces + "\xef\xbb\xbf"
                                  "f 1 2 3\n"),
              Lines{"line 7: \"\\xef\\xbb\\xbf"
                    "f\" is passed over: no keyword of the format"});
    std::string many = faces;
    for (int i = 0; i < 30; ++i) {
        many += fmt::format("x{}\n", i);
    }
    ASSERT_EQ(warnings_of(many).size(), 21u);
    EXPECT_EQ(warnings_of(many)[20], "10 more warnings of other kinds");
}

TEST(OddObjTest, FoIsTheOldSpellingOfF) {
    const Mesh mesh = parse_obj(square + "fo 1 2 3\nf 1 3 4\n", "a");
    EXPECT_EQ(area_of(mesh), 4);
    EXPECT_EQ(mesh.warnings.messages(), Lines());
}

// The inner corner is the second one, so that the fan covers 8 where the polygon has 4.
TEST(OddObjTest, ConcavePolygonsHaveTheirArea) {
    const std::string vertices = "v 4 0 0\nv 1 1 0\nv 0 4 0\nv 0 0 0\n";
    const std::string others = "vt .4 0\nvt .1 .1\nvt 0 .4\nvt 0 0\nvn 0 0 4\nvn 0 0 1\nvn 0 0 2\nvn 0 0 3\n";
    for (const bool is_late : {false, true}) {
        const std::string face = "f 1/1/1 2/2/2 3/3/3 4/4/4\n";
        const Mesh mesh = parse_obj(is_late ? others + face + vertices : vertices + others + face, "a");
        EXPECT_EQ(area_of(mesh), 4);
        EXPECT_EQ(mesh.warnings.messages(), Lines());
        ASSERT_EQ(mesh.coordinates.size(), 2u);
        for (std::size_t i = 0; i < 2; ++i) {
            for (std::size_t k = 0; k < 3; ++k) {
                const auto& vertex = mesh.vertices[mesh.triangles[i][k]];
                EXPECT_FLOAT_EQ(mesh.coordinates[i][k][0], vertex[0] / 10);
                EXPECT_FLOAT_EQ(mesh.coordinates[i][k][1], vertex[1] / 10);
                EXPECT_EQ(mesh.normals[mesh.triangles[i][k]][2], vertex[0] == 4   ? 4
                                                                 : vertex[0] == 1 ? 1
                                                                 : vertex[1] == 4 ? 2
                                                                                  : 3);
            }
        }
    }
    const ObjParts parts = parse_obj_parts(vertices + "f 1 2 3 4\n", "a");
    EXPECT_EQ(area_of(parts.mesh), 4);
    EXPECT_EQ(area_of(parse_ply(ply_of("4 0 0\n1 1 0\n0 4 0\n0 0 0\n4 0 1 2 3\n", 4, "face 1"), "a")), 4);
    const std::string faces_first =
        "ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int vertex_indices\nelement vertex 4\nproperty "
        "float x\nproperty float y\nproperty float z\nend_header\n4 0 1 2 3\n4 0 0\n1 1 0\n0 4 0\n0 0 0\n";
    EXPECT_EQ(area_of(parse_ply(faces_first, "a")), 4);
}

TEST(OddObjTest, PolygonsInDoubtHaveTheirLine) {
    const std::string bent = "v 0 0 0\nv 2 0 0\nv 2 2 1\nv 0 2 0\n";
    const Lines told = {"line 5: a polygon whose corners lie in no plane: which way it is bent is not said"};
    EXPECT_EQ(warnings_of(bent + "f 1 2 3 4\n"), told);
    EXPECT_EQ(warnings_of(bent + "f 1 2 3\nf 1 3 4\n"), Lines());
    EXPECT_EQ(warnings_of(square + "f 1 3 2 4\n"),
              Lines{"line 5: a polygon whose edges cross each other: it is shown as the fan around its first corner"});
    EXPECT_EQ(parse_ply(ply_of("0 0 0\n2 0 0\n2 2 1\n0 2 0\n4 0 1 2 3\n", 4, "face 1"), "a").warnings.messages(),
              Lines{"face 0: a polygon whose corners lie in no plane: which way it is bent is not said"});
}

// A survey's square of 10 m in a zone's easting and northing: its northings are told apart to half a metre.
TEST(OddObjTest, CoordinatesBeyondSinglePrecisionAreTold) {
    const auto corners = [](double x, double y, const std::string& before) {
        std::string text;
        for (const auto& [u, v] : {std::pair{0, 0}, {10, 0}, {10, 10}, {0, 10}}) {
            text += fmt::format("{}{} {} 12.5\n", before, x + u, y + v);
        }
        return text;
    };
    const std::string faces = "f 1 2 3\nf 1 3 4\n";
    const std::string told =
        "coordinates with more digits than single precision has: vertices are moved by up to 0.08, of a mesh 10 across "
        "whose edges are 11 long on average; take an origin such as (500010, 4649780, 10) from them, and give it to "
        "the "
        "object as its \"translate\"";
    const double x = 500000.123, y = 4649776.42;
    EXPECT_EQ(warnings_of(corners(x, y, "v ") + faces), Lines{"line 1: " + told});
    EXPECT_EQ(warnings_of(corners(x - 500000, y - 4649776, "v ") + faces), Lines());
    EXPECT_EQ(warnings_of(corners(500000, 4649776, "v ") + faces), Lines());  // are numbers of single precision
    EXPECT_EQ(warnings_of(corners(x * 1e-6, y * 1e-6, "v ") + faces), Lines());
    const std::string ply_faces = "3 0 1 2\n3 0 2 3\n";
    for (const std::string type : {"float", "double"}) {
        EXPECT_EQ(parse_ply(ply_of(corners(x, y, "") + ply_faces, 4, "face 2", type), "a").warnings.messages(),
                  Lines{"vertex 0: " + told})
            << type;
    }
}

TEST(OddPlyTest, StripsAreTriangles) {
    const Mesh mesh =
        parse_ply(ply_of("0 0 0\n2 0 0\n0 2 0\n2 2 0\n0 4 0\n9 0 1 2 3 4 -1 0 2 1\n", 5, "tristrips 1"), "a");
    EXPECT_EQ(mesh.triangles, (Triangles{{0, 1, 2}, {2, 1, 3}, {2, 3, 4}, {0, 2, 1}}));
    try {
        (void)parse_ply(ply_of("0 0 0\n1 0\n", 1, "edge 1"), "a");
        ADD_FAILURE();
    } catch (const InputError& error) {
        EXPECT_EQ(std::string(error.what()),
                  "a: header: found no faces, but vertex, edge, allowed: an element \"face\" with a list "
                  "\"vertex_indices\", or \"tristrips\" with one");
    }
}

TEST(OddMtlTest, NamesGoToTheLinesEnd) {
    const std::vector<MtlMaterial> materials =
        parse_mtl("newmtl Material #25\nKd 1 0 0 # red\nmap_Kd a#1.png # b\n# c\\\nnewmtl red, or so\nKd 1,0,0\n", "a");
    ASSERT_EQ(materials.size(), 2u);
    EXPECT_EQ(materials[0].name, "Material #25");
    EXPECT_EQ(materials[0].lines.at("kd").text(), "Kd 1 0 0");
    EXPECT_EQ(materials[0].lines.at("map_kd").text(), "map_Kd a#1.png # b");
    EXPECT_EQ(materials[1].name, "red, or so");
    EXPECT_EQ(without_comment("Material #25"), "Material");
    EXPECT_EQ(without_comment("a#1.png  # b # c"), "a#1.png");
    EXPECT_EQ(without_comment("#1"), "#1");
    const ObjParts parts = parse_obj_parts(
        "mtllib a #1.mtl\n" + square + "usemtl Material #25\nf 1 2 3\nusemtl Material #26\nf 1 3 4\n", "a");
    EXPECT_EQ(parts.libraries, Lines{"a #1.mtl"});
    ASSERT_EQ(parts.parts.size(), 2u);
    EXPECT_EQ(parts.parts[0].material, "Material #25");
    EXPECT_EQ(parts.parts[1].material, "Material #26");
}

}  // namespace
}  // namespace pt
