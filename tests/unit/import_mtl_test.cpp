// Meshes with the materials of their own files: .obj and .mtl, in the text and the JSON format of CIS 565.
#include "harness/interchange/import_mtl.h"

#include <gtest/gtest.h>

#include "harness/interchange/import_course_json.h"
#include "harness/mesh/read_mesh.h"
#include "tests/support/cis565_texts.h"
#include "tests/support/command.h"
#include "tests/support/places.h"

namespace pt {
namespace {

using test::replaced;
using Lines = std::vector<std::string>;

// Two squares side by side in the plane z = 0, a material each.
const std::string two_squares =
    "mtllib two.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nv 2 1 0\n"
    "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
    "usemtl left side\nf 1/1 2/2 3/3 4/4\nusemtl right\nf 2/1 5/2 6/3 3/4\n";
// A closed mesh, as glass must have.
const std::string tetrahedron =
    "mtllib two.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nusemtl right\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
const std::string left = "newmtl left side\nKd 0.25 0.5 0.75\n";

class Course {
public:
    explicit Course(const std::string& library, const std::string& mesh = two_squares) {
        test::write_text(folder.file("two.mtl"), library);
        test::write_text(folder.file("two.obj"), mesh);
    }
    ImportResult import(const std::string& material = "material -1\n") const {
        std::string text = replaced(test::with_material("RGB 1 1 1\n"), "cube\n", "mesh\nFILE two.obj\n");
        text = replaced(text, "EYE 1 2 3\nLOOKAT 1 2 0", "EYE 1 2 9\nLOOKAT 1 2 0");
        return import_cis565({.text = replaced(text, "material 0\n", material),
                              .file = folder.file("a.txt"),
                              .out = folder.file("out.json"),
                              .name = ""});
    }
    // The problems of an import whose material `right` has these lines.
    static Lines problems_of(const std::string& lines, const std::string& mesh = two_squares) {
        return Course(left + "newmtl right\n" + lines, mesh).import().problems.messages("a", "");
    }
    static Lines warnings_of(const std::string& lines, const std::string& mesh = two_squares) {
        const ImportResult result = Course(left + "newmtl right\n" + lines, mesh).import();
        EXPECT_EQ(result.problems.messages("a", ""), Lines()) << lines;
        return result.warnings.messages("a", "warning");
    }
    // The JSON that the scene has for the material of these lines.
    static std::string material_of(const std::string& lines, const std::string& mesh = two_squares) {
        const ImportResult result = Course(left + "newmtl right\n" + lines, mesh).import();
        EXPECT_EQ(result.problems.messages("a", ""), Lines()) << lines;
        const std::string start = "    \"right\": ";
        const std::size_t at = result.json.find(start);
        EXPECT_NE(at, std::string::npos) << result.json;
        return at == std::string::npos
                   ? ""
                   : result.json.substr(at + start.size(), result.json.find('\n', at) - at - start.size());
    }
    test::TemporaryFolder folder;
};

TEST(ImportMtl, EachMaterialIsAnObjectWithItsTriangles) {
    const Course course(left + "newmtl right\nKd 0.5\nillum 2\n");
    const ImportResult result = course.import();
    ASSERT_EQ(result.problems.messages("a", ""), Lines());
    EXPECT_EQ(result.warnings.count(), 0u);
    EXPECT_EQ(result.objects, 2u);
    EXPECT_EQ(result.materials, 3u);
    const std::string objects = result.json.substr(result.json.find("\"objects\""));
    EXPECT_EQ(objects, R"("objects": [
    {"shape": "mesh", "file": "out_mesh_0.ply", "material": "left_side"},
    {"shape": "mesh", "file": "out_mesh_1.ply", "material": "right"}
  ]
}
)");
    EXPECT_NE(result.json.find(R"("left_side": {"type": "diffuse", "albedo": [0.25, 0.5, 0.75]})"), std::string::npos);
    EXPECT_NE(result.json.find(R"("right": {"type": "diffuse", "albedo": [0.5, 0.5, 0.5]})"), std::string::npos);
    ASSERT_EQ(result.meshes.size(), 2u);
    const Mesh& second = result.meshes[1].mesh;
    using Point = std::array<float, 3>;
    EXPECT_EQ(second.vertices, (std::vector<Point>{{1, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}}));
    using Corners = std::array<std::uint32_t, 3>;
    EXPECT_EQ(second.triangles, (std::vector<Corners>{{0, 1, 2}, {0, 2, 3}}));
    ASSERT_EQ(second.coordinates.size(), 2u);
    EXPECT_EQ(second.coordinates[1][2], (std::array<float, 2>{0, 1}));
}

TEST(ImportMtl, PlacedAndMovedAsTheObjectIs) {
    const Course course(left + "newmtl right\nKd 0.5\n");
    const ImportResult result = course.import("material -1\nVEL 0 1 0\n");
    ASSERT_EQ(result.problems.messages("a", ""), Lines());
    const std::string moved = "\"velocity\": [0, 1, 0]";
    const std::size_t first = result.json.find(moved);
    ASSERT_NE(first, std::string::npos) << result.json;
    EXPECT_NE(result.json.find(moved, first + 1), std::string::npos) << result.json;
}

TEST(ImportMtl, AMeshOfOneMaterialStaysInItsFile) {
    const Course course("newmtl right\nKd 0.5\n", tetrahedron);
    const ImportResult result = course.import();
    EXPECT_EQ(result.problems.messages("a", ""), Lines());
    EXPECT_TRUE(result.meshes.empty());
    EXPECT_NE(result.json.find(R"({"shape": "mesh", "file": "two.obj", "material": "right"})"), std::string::npos)
        << result.json;
}

TEST(ImportMtl, InJsonWhereNoMaterialIsNamed) {
    const Course course(left + "newmtl right\nKd 0.5\n");
    const std::string text = R"({"Materials": {"right": {"TYPE": "Diffuse", "RGB": [1, 1, 1]}},
"Camera": {"RES": [4, 3], "FOVY": 30, "DEPTH": 5, "EYE": [1, 2, 9], "LOOKAT": [1, 2, 0], "UP": [0, 1, 0]},
"Objects": [{"TYPE": "obj", "FILENAME": "two.obj"}]})";
    const ImportResult result = import_course_json(
        {.text = text, .file = course.folder.file("a.json"), .out = course.folder.file("out.json"), .name = ""});
    ASSERT_EQ(result.problems.messages("a", ""), Lines());
    // The scene's own has the name already.
    EXPECT_NE(result.json.find(R"("file": "out_mesh_1.ply", "material": "right_2"})"), std::string::npos)
        << result.json;
}

TEST(ImportMtl, AMeshThatAnotherObjectShowsIsWrittenOnce) {
    const Course course(left + "newmtl right\nKd 0.5\n");
    std::string text =
        replaced(test::with_material("RGB 1 1 1\n"), "cube\nmaterial 0", "mesh\nFILE two.obj\nmaterial -1");
    text += "\nOBJECT 1\nmesh\nFILE two.obj\nmaterial -1\nTRANS 5 0 0\nROTAT 0 0 0\nSCALE 1 1 1\n";
    const ImportResult result = import_cis565(
        {.text = text, .file = course.folder.file("a.txt"), .out = course.folder.file("out.json"), .name = ""});
    ASSERT_EQ(result.problems.messages("a", ""), Lines());
    EXPECT_EQ(result.meshes.size(), 2u);
    EXPECT_EQ(result.objects, 4u);
}

TEST(ImportMtl, Emitters) {
    EXPECT_EQ(Course::material_of("Kd 0\nKe 3 2 1\n"), R"({"type": "emitter", "radiance": [3, 2, 1]})"
                                                       "");
    EXPECT_EQ(Course::warnings_of("Kd 0.5\nKe 3 2 1\n"),
              Lines{"a:14: warning: two.mtl line 4: Kd 0.5 is not used: it is an emitter, by Ke"});
}

TEST(ImportMtl, GlassByIllumination) {
    for (const std::string illumination : {"4", "6", "7", "9"}) {
        EXPECT_EQ(Course::material_of("Ni 1.25\nTf 1 0.5 1\nd 0\nillum " + illumination + "\n", tetrahedron),
                  R"({"type": "dielectric", "ior": 1.25, "tint": [1, 0.5, 1]})");
    }
    EXPECT_EQ(Course::warnings_of("Kd 0.5\nillum 7\n", tetrahedron),
              (Lines{"a:14: warning: two.mtl line 5: illum 7 is glass without an Ni: of index 1.5",
                     "a:14: warning: two.mtl line 4: Kd 0.5 is not used: it is glass, by illum 7"}));
    const Lines problems = Course::problems_of("Ni 1.5\nillum 7\n");
    ASSERT_EQ(problems.size(), 1u);
    EXPECT_NE(problems[0].find("not closed"), std::string::npos) << problems[0];
}

// The diffuse lobe and the mirror of a mix reflect Kd + Ks together: albedo (1 - p) and reflectance p, exact in these
// numbers.
TEST(ImportMtl, AMirrorBesideADiffuseColour) {
    EXPECT_EQ(Course::material_of("Kd 0\nKs 0.5 0.25 0\nillum 3\n"),
              R"({"type": "mirror", "reflectance": [0.5, 0.25, 0]})");
    EXPECT_EQ(Course::material_of("Kd 0.25 0.125 0\nKs 0.25 0.125 0.0625\nillum 3\n"),
              R"({"type": "mix", "albedo": [0.5, 0.25, 0], "reflectance": [0.5, 0.25, 0.125], )"
              R"("mirror_probability": 0.5})");
    EXPECT_EQ(Course::warnings_of("Kd 0.25\nKs 0.25\nillum 3\n"), Lines());
    EXPECT_EQ(Course::material_of("Kd 1\nKs 1\nillum 3\n"),
              R"({"type": "mix", "albedo": [1, 1, 1], "reflectance": [1, 1, 1], "mirror_probability": 0.5})");
    EXPECT_EQ(Course::warnings_of("Kd 1\nKs 1\nillum 3\n"),
              Lines{"a:14: warning: two.mtl line 5: Ks 1 and Kd reflect more than comes, 2: both are divided by that"});
    EXPECT_EQ(Course::warnings_of("Kd 0\nKs 1\nillum 5\n"),
              Lines{"a:14: warning: two.mtl line 6: illum 5 has a mirror by Fresnel's share: read as one that reflects "
                    "Ks from everywhere"});
    EXPECT_EQ(Course::material_of("Kd 0.5\nKs 0\nillum 3\n"), R"({"type": "diffuse", "albedo": [0.5, 0.5, 0.5]})");
}

TEST(ImportMtl, AnImage) {
    const std::string tiles = test::in_source("scenes/textures/tiles.png");
    const Course course(left + "newmtl right\nKd 1 1 1\nmap_Kd my tiles.png\n");
    std::filesystem::copy(tiles, course.folder.path() / "my tiles.png");
    const ImportResult result = course.import();
    ASSERT_EQ(result.problems.messages("a", ""), Lines());
    EXPECT_NE(result.json.find(R"("right": {"type": "diffuse", "albedo": {"image": "my tiles.png"}})"),
              std::string::npos)
        << result.json;
    EXPECT_EQ(result.warnings.messages("a", "warning"),
              Lines{"a:14: warning: two.mtl line 5: map_Kd my tiles.png is read as sRGB with v upwards; the format "
                    "does not say"});
    EXPECT_EQ(Course::problems_of("map_Kd wood.png\n"),
              Lines{"a:14: found \"two.mtl line 4: map_Kd wood.png\", allowed: an image .png or .jpg that is there, "
                    "beside the library or in a folder above the scene"});
    EXPECT_EQ(Course::problems_of("map_Kd -s 2 2 2 wood.png\n"),
              Lines{"a:14: found \"two.mtl line 4: map_Kd -s 2 2 2 wood.png\", allowed: map_Kd and an image (options "
                    "of maps are not read)"});
}

TEST(ImportMtl, WhatIsLostIsAWarning) {
    EXPECT_EQ(Course::warnings_of("Ka 1 1 1\nKd 0.5\nNs 10\nNi 1.5\nd 1\nTr 0\nillum 1\nKs 0\nPm 0\n"), Lines());
    EXPECT_EQ(Course::warnings_of("Kd 0.5\nKs 0.5\nillum 2\n"),
              Lines{"a:14: warning: two.mtl line 5: Ks 0.5 is lost: highlights of lamps alone are no reflection"});
    EXPECT_EQ(Course::warnings_of("Kd 0.5\nPr 0.25\n"),
              Lines{"a:14: warning: two.mtl line 5: Pr 0.25 is lost: scene files have nothing like it"});
    EXPECT_EQ(
        Course::warnings_of("Kd 0.5\nillum 0\n"),
        Lines{"a:14: warning: two.mtl line 5: illum 0 is read as illum 1: without shading it would be no surface"});
}

TEST(ImportMtl, ProblemsNameTheFileTheLineAndTheValue) {
    const std::string at = "a:14: found \"two.mtl line 5: ";
    const auto problem_of = [&](const std::string& line) {
        const Lines problems = Course::problems_of("Kd 0.5\n" + line + "\n");
        EXPECT_EQ(problems.size(), 1u) << line;
        return problems.empty() ? "" : problems[0];
    };
    EXPECT_EQ(
        problem_of("d 0.5"),
        at + "d 0.5\", allowed: 1, or Tr 0 (of what light goes through, scene files have glass: illum 4, 6, 7 or 9)");
    EXPECT_EQ(
        problem_of("norm a.png"),
        at + "norm a.png\", allowed: no image here (map_Kd is read; no normal, bump, opacity or emission map is)");
    EXPECT_EQ(problem_of("Kq 1 2"), at + "Kq 1 2\", allowed: Ka, Kd, Ks, Ke, Ns, Ni, Tf, d, Tr, illum or map_Kd");
    EXPECT_EQ(problem_of("Ke 1 2"), at + "Ke 1 2\", allowed: 1 or 3 finite numbers");
    EXPECT_EQ(problem_of("illum 10"), at + "illum 10\", allowed: a whole number from 0 to 9");
    EXPECT_EQ(problem_of("Kd 0.5 2 0.5"),
              at + "Kd 0.5 2 0.5\", which makes $.materials.right.albedo[1] 2, allowed: a number from 0 to 1");
    EXPECT_EQ(Course::problems_of("Ns 5\n"),
              Lines{"a:14: found \"two.mtl line 3: newmtl right\" without Kd, allowed: with it"});
}

TEST(ImportMtl, LibrariesAndNamesThatAreNotThere) {
    EXPECT_EQ(Course(left).import().problems.messages("a", ""),
              Lines{"a:14: found \"two.obj: usemtl right\", allowed: a material of its libraries, mtllib"});
    const Course without("", replaced(two_squares, "mtllib two.mtl", "mtllib three.mtl"));
    EXPECT_EQ(without.import().problems.messages("a", ""),
              Lines{"a:14: found \"two.obj: mtllib three.mtl\", allowed: a library of materials that is there, beside "
                    "the mesh"});
    const Course broken("Kd 1 1 1\n");
    const Lines problems = broken.import().problems.messages("a", "");
    ASSERT_EQ(problems.size(), 1u);
    EXPECT_NE(problems[0].find("line 1: found \"Kd 1 1 1\", allowed: newmtl and a name, at most 10000 of them"),
              std::string::npos)
        << problems[0];
    const Course bare("newmtl right\nKd 1\n", "mtllib two.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    EXPECT_EQ(bare.import().problems.messages("a", ""),
              Lines{"a:14: found \"two.obj: faces before any usemtl\", allowed: a material of its libraries, mtllib"});
}

TEST(ImportMtl, ALibrarysNameMayHaveSpaces) {
    const Course course("", replaced(two_squares, "mtllib two.mtl", "mtllib  a  low  .mtl\r"));
    test::write_text(course.folder.file("a  low  .mtl"),
                     replaced(left, "left side", "left  side") + "newmtl right\nKd 1\n");
    EXPECT_EQ(course.import().problems.messages("a", ""), Lines());
    const Course several(left, replaced(two_squares, "mtllib two.mtl", "mtllib two.mtl other.mtl"));
    test::write_text(several.folder.file("other.mtl"), "newmtl right\nKd 1\n");
    EXPECT_EQ(several.import().problems.messages("a", ""), Lines());
}

// "Material #25" is one name; "wood # of the floor" may be a name and a comment.
TEST(ImportMtl, NamesWithANumberSignAreNotMerged) {
    const std::string mesh = replaced(replaced(two_squares, "left side", "Material #25"), "right", "Material #26");
    const Course course("newmtl Material #25\nKd 1 0 0\nnewmtl Material #26\nKd 0 1 0\n", mesh);
    const ImportResult result = course.import();
    ASSERT_EQ(result.problems.messages("a", ""), Lines());
    EXPECT_EQ(result.warnings.count(), 0u);
    EXPECT_NE(result.json.find(R"("Material__25": {"type": "diffuse", "albedo": [1, 0, 0]})"), std::string::npos)
        << result.json;
    EXPECT_NE(result.json.find(R"("Material__26": {"type": "diffuse", "albedo": [0, 1, 0]})"), std::string::npos);
    const std::string commented = replaced(two_squares, "right", "right # of both");
    const auto warnings = [](const ImportResult& found) {
        EXPECT_EQ(found.problems.messages("a", ""), Lines());
        return found.warnings.messages("a", "warning");
    };
    EXPECT_EQ(
        warnings(Course(left + "newmtl right\nKd 1\n", commented).import()),
        Lines{"a:14: warning: two.obj: \"right # of both\" is read as the material \"right\", as if a comment began "
              "at #"});
    EXPECT_EQ(
        warnings(Course(left + "newmtl right # it is\nKd 1\n").import()),
        Lines{"a:14: warning: two.obj: \"right\" is read as the material \"right # it is\", as if a comment began "
              "at #"});
    const Course missing("newmtl Material #25\nKd 1 0 0\n", mesh);
    EXPECT_EQ(missing.import().problems.messages("a", ""),
              Lines{"a:14: found \"two.obj: usemtl Material #26\", allowed: a material of its libraries, mtllib"});
    const Course doubtful(left + "newmtl right # 1\nKd 1\nnewmtl right # 2\nKd 1\n");
    EXPECT_EQ(doubtful.import().problems.count(), 1u);
    const Course named(left, replaced(two_squares, "two.mtl", "two.mtl # mine\nmtllib a #1.mtl"));
    test::write_text(named.folder.file("a #1.mtl"), "newmtl right\nKd 1\n");
    EXPECT_EQ(named.import().problems.messages("a", ""), Lines());
}

TEST(ImportMtl, ANameThatIsDefinedTwiceIsTold) {
    const std::string twice = left + "newmtl right\nKd 0.5\nnewmtl right\nKd 0.25\n";
    const ImportResult result = Course(twice).import();
    ASSERT_EQ(result.problems.messages("a", ""), Lines());
    EXPECT_NE(result.json.find(R"("albedo": [0.5, 0.5, 0.5])"), std::string::npos);
    EXPECT_EQ(result.warnings.messages("a", "warning"),
              Lines{"a:14: warning: two.mtl line 5: newmtl right is not used: two.mtl line 3 has another of that name, "
                    "the first"});
    const Course over_two(left + "newmtl right\nKd 0.5\n",
                          replaced(two_squares, "two.mtl", "two.mtl\nmtllib other.mtl\nmtllib two.mtl"));
    test::write_text(over_two.folder.file("other.mtl"), "newmtl left side\nKd 0.25 0.5 0.75\nnewmtl right\nKd 1\n");
    EXPECT_EQ(over_two.import().warnings.messages("a", "warning"),
              Lines{"a:14: warning: other.mtl line 3: newmtl right is not used: two.mtl line 3 has another of that "
                    "name, the first"});
    EXPECT_EQ(Course::warnings_of("Kd 0.5\nKd 0.25\nNs 1\nNs 1\n"),
              Lines{"a:14: warning: two.mtl line 4: Kd 0.5 is not used: a later line says it again"});
}

TEST(ImportMtl, WhatItsMeshFileHasBesidesIsTold) {
    EXPECT_EQ(Course::warnings_of("Kd 0.5\n", two_squares + "l 1 2\n"),
              Lines{"a:14: warning: two.obj: line 16: p or l is passed over: points and lines have no area"});
}

TEST(ImportMtl, AGroupsNameStandsForAMaterialThatIsMissing) {
    const Course course("newmtl right\nKd 0.98, 0.5, 0.25\n",
                        "mtllib two.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\ng right\nf 1 2 3\nusemtl gone\nf 1 2 3\n");
    const ImportResult result = course.import();
    ASSERT_EQ(result.problems.messages("a", ""), Lines());
    EXPECT_NE(result.json.find(R"("albedo": [0.98, 0.5, 0.25])"), std::string::npos) << result.json;
    EXPECT_EQ(result.warnings.messages("a", "warning"),
              Lines{"a:14: warning: two.obj has faces whose material no library has: they are of \"right\", as their "
                    "group is called"});
}

TEST(ImportMtl, MeshesOfOtherFormatsHaveNone) {
    const Course course("");
    test::write_text(course.folder.file("two.ply"), "ply");
    const std::string text =
        replaced(test::with_material("RGB 1 1 1\n"), "cube\nmaterial 0", "mesh\nFILE two.ply\nmaterial -1");
    const ImportResult result = import_cis565(
        {.text = text, .file = course.folder.file("a.txt"), .out = course.folder.file("out.json"), .name = ""});
    EXPECT_EQ(result.problems.messages("a", ""),
              Lines{"a:15: found \"material -1\", allowed: a material (of mesh files "
                    "only the materials of .obj are read)"});
}

}  // namespace
}  // namespace pt
