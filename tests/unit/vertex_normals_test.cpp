// The normals of a mesh's vertices: as scenes ask for them, from every kind of file, from generators; what is refused;
// and what of them is in a scene's hash.
#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "harness/failure.h"
#include "harness/mesh/generate.h"
#include "harness/mesh/generators.h"
#include "harness/mesh/vertex_normals.h"
#include "harness/scene/scene.h"
#include "tests/support/command.h"

namespace pt {
namespace {

std::string text_of(const std::string& mesh, const std::string& material = R"("diffuse", "albedo": [1, 1, 1])") {
    return R"({"name": "s", "max_depth": 4, "camera": {"eye": [0, 1, 5], "look_at": [0, 1, 0], "up": [0, 1, 0],
               "vertical_fov_degrees": 40, "resolution": [8, 6]},
               "materials": {"m": {"type": )" +
           material + R"(}}, "objects": [{"shape": "mesh", "material": "m", )" + mesh + "}]}";
}

Scene scene_of(const std::string& mesh, const std::string& file = "s.json") { return parse_scene(text_of(mesh), file); }

std::string error_of(const std::string& mesh, const std::string& file = "s.json") {
    try {
        (void)scene_of(mesh, file);
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

const std::string triangle = R"("vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "triangles": [[0, 1, 2]])";
const std::string asked = R"(, "shading_normals": true)";

Vec3<float> corner(const Scene& scene, int i) {
    const auto& normal = scene.meshes.at(0)->normals.at(0).of[i];
    return {normal[0], normal[1], normal[2]};
}

const float half = static_cast<float>(std::sqrt(0.5));

TEST(VertexNormals, AreThereWhereTheyAreAskedFor) {
    const std::string with = triangle + R"(, "normals": [[0, 0, 7], [1, 0, 1], [0, 1e-20, 1e-20]])";
    const Scene plain = scene_of(triangle), passed_over = scene_of(with), scene = scene_of(with + asked);
    EXPECT_TRUE(passed_over.meshes.at(0)->normals.empty());
    EXPECT_FALSE(passed_over.objects[0].shading_normals);
    EXPECT_EQ(features_of(passed_over), features_of(plain));
    EXPECT_TRUE(scene.objects[0].shading_normals);
    EXPECT_EQ(features_of(scene), features_of(plain) | Feature::shading_normals);
    // The least corner stands first: (0, 0, 0), then (1, 0, 0), (0, 1, 0).
    EXPECT_EQ(corner(scene, 0), Vec3<float>(0, 0, 1));
    EXPECT_EQ(corner(scene, 1), Vec3<float>(half, 0, half));
    EXPECT_EQ(corner(scene, 2), Vec3<float>(0, half, half));
    EXPECT_EQ(scene.meshes[0]->hash, plain.meshes.at(0)->hash);
    // An emitter has no use for them.
    EXPECT_FALSE(contains(features_of(parse_scene(text_of(with + asked, R"("emitter", "radiance": [1, 1, 1])"), "s")),
                          Feature::shading_normals));
}

TEST(VertexNormals, GoWithTheCornersOfATurnedTriangle) {
    const Scene scene = scene_of(
        R"("vertices": [[1, 0, 0], [0, 1, 0], [0, 0, 0]], "triangles": [[0, 1, 2]], "normals": [[1, 0, 1], [0, 1, 1], [0, 0, 1]])" +
        asked);
    EXPECT_EQ(corner(scene, 0), Vec3<float>(0, 0, 1));
    EXPECT_EQ(corner(scene, 1), Vec3<float>(half, 0, half));
    EXPECT_EQ(corner(scene, 2), Vec3<float>(0, half, half));
}

TEST(VertexNormals, PointToTheOutside) {
    const Scene scene = scene_of(triangle + R"(, "normals": [[0, 0, -1], [1, 0, -1], [0, 1, -1]])" + asked);
    EXPECT_EQ(corner(scene, 0), Vec3<float>(0, 0, 1));
    EXPECT_EQ(corner(scene, 1), Vec3<float>(-half, 0, half));
    EXPECT_EQ(corner(scene, 2), Vec3<float>(0, -half, half));
}

// The triangle's own, as files round them, are marked by zeros: kernels take the triangle's.
TEST(VertexNormals, ThatAreTheTrianglesOwnAreLeftToIt) {
    const auto first = [](const std::string& x) {
        return corner(scene_of(triangle + R"(, "normals": [[)" + x + ", 0, 1], [0, 0, 2], [0, 0, 1]]" + asked), 0);
    };
    EXPECT_EQ(first("0"), Vec3<float>(0, 0, 0));
    EXPECT_EQ(first("9e-7"), Vec3<float>(0, 0, 0));
    EXPECT_EQ(first("1e-6"), Vec3<float>(1e-6f, 0, 1));
}

TEST(VertexNormals, AreInTheScenesHashWhereTheyAreAskedFor) {
    const test::TemporaryFolder folder;
    const auto hash = [&](const std::string& normal, const std::string& keys) {
        test::write_text(folder.file("m.obj"),
                         "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn " + normal + "\nvn 0 0 1\nf 1//1 2//2 3//2\n");
        return scene_of("\"file\": \"m.obj\"" + keys, folder.file("s.json")).hash;
    };
    EXPECT_EQ(hash("1 0 1", ""), hash("1 1 1 ", ""));
    EXPECT_NE(hash("1 0 1", asked), hash("1 1 1 ", asked));
}

TEST(VertexNormals, AreReadFromFiles) {
    const test::TemporaryFolder folder;
    test::write_text(folder.file("m.obj"),
                     "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nvn 0 2 2\nvn 3 0 3\nf 1//1 2//3 3//2\n");
    test::write_text(folder.file("m.ply"),
                     "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
                     "property float nx\nproperty float ny\nproperty float nz\nelement face 1\n"
                     "property list uchar int vertex_indices\nend_header\n0 0 0 0 0 1\n1 0 0 1 0 1\n0 1 0 0 1 1\n"
                     "3 0 1 2\n");
    for (const char* const name : {"m.obj", "m.ply"}) {
        const Scene scene = scene_of("\"file\": \"" + std::string(name) + "\"" + asked, folder.file("s.json"));
        EXPECT_EQ(corner(scene, 0), Vec3<float>(0, 0, 1)) << name;
        EXPECT_EQ(corner(scene, 1), Vec3<float>(half, 0, half)) << name;
        EXPECT_EQ(corner(scene, 2), Vec3<float>(0, half, half)) << name;
    }
}

TEST(VertexNormals, ThatAreWrongAreRefusedInOneLine) {
    const test::TemporaryFolder folder;
    const std::string vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    test::write_text(folder.file("none.obj"), vertices + "f 1 2 3\n");
    test::write_text(folder.file("some.obj"), vertices + "vn 0 0 1\nf 1//1 2//1 3\n");
    test::write_text(folder.file("zero.obj"), vertices + "vn 0 0 1\nvn 0 0 0\nf 1//1 2//2 3//1\n");
    test::write_text(folder.file("nan.obj"), vertices + "vn 0 0 1\nvn 0 nan 0\nf 1//1 2//2 3//1\n");
    const std::string place = "s.json: $.objects[0]";
    for (const auto& [mesh, expected] : std::vector<std::pair<std::string, std::string>>{
             {triangle + asked,
              place + ".shading_normals: found true, allowed: false: the mesh of the scene file has no normals of its "
                      "vertices"},
             {triangle + R"(, "normals": [[0, 0, 1], [0, 0, 1]])",
              ".normals: found an array of 2, allowed: one for each of the 3 vertices"},
             {triangle + R"(, "normals": [[0, 0, 1], [0, 0, 0], [0, 0, 1]])",
              place + ".normals[1]: found [0,0,0], allowed: a direction that is not 0 in single precision"},
             {triangle + R"(, "normals": [[0, 0, 1], [0, 1e-60, 0], [0, 0, 1]])", "not 0 in single precision"},
             {triangle + R"(, "normals": [[0, 0, 1], [0, 1], [0, 0, 1]])", "allowed: [x, y, z]"},
             {triangle + R"(, "normals": [[0, 0, 1], [0, 1, 1e60], [0, 0, 1]])", "a number of single precision"},
             {triangle + R"(, "shading_normals": 1)", place + ".shading_normals: found 1, allowed: true or false"},
             {R"("generate": {"mesh": "icosphere", "size": 0}, "normals": [[0, 0, 1]])",
              "\"normals\" with \"vertices\", or neither"},
             {R"("generate": {"mesh": "menger", "size": 0})" + asked,
              "allowed: false: the mesh menger 0 has no normals of its vertices"},
             {R"("file": "none.obj")" + asked, "allowed: false: the mesh none.obj has no normals of its vertices"},
             {R"("file": "some.obj")" + asked, "allowed: false: the mesh some.obj has no normals of its vertices"},
             {R"("file": "zero.obj")" + asked,
              "allowed: false: in the mesh zero.obj the normal of vertex 1 (from 0) is (0, 0, 0)"},
             {R"("file": "nan.obj")" + asked,
              "nan.obj: normal of vertex 1: found (0, nan, 0), allowed: finite numbers"}}) {
        const std::string message = error_of(mesh, folder.file("s.json"));
        EXPECT_NE(message.find(expected), std::string::npos) << mesh << ": " << message;
        EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    }
    EXPECT_EQ(error_of("\"file\": \"none.obj\"", folder.file("s.json")), "");
    EXPECT_EQ(error_of("\"file\": \"zero.obj\"", folder.file("s.json")), "");
    EXPECT_NE(error_of(R"("file": "a.obj", "shape": "sphere")"), "");
}

// Max's weights are exact on a ball, whose vertices are its normals, whatever triangles lie between them.
TEST(VertexNormals, ComputedOnABallAreTheBalls) {
    for (const std::uint32_t rows : {3u, 8u, 33u}) {
        Mesh mesh = make_grid_sphere(rows, 0, 1);
        give_vertex_normals(mesh);
        ASSERT_EQ(mesh.normals.size(), mesh.vertices.size());
        for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
            for (std::size_t axis = 0; axis < 3; ++axis) {
                // Vertices are rounded to 2^-24, over sides of 1 / 33.
                EXPECT_NEAR(mesh.normals[i][axis], mesh.vertices[i][axis], 1e-5) << rows << " " << i;
            }
        }
    }
}

// Two vertices at one place, as where patches meet, have one normal.
TEST(VertexNormals, ComputedDoNotKnowSeams) {
    Mesh whole = make_grid_sphere(6, 0.1, 3), cut = whole;
    cut.vertices.clear();
    for (auto& indices : cut.triangles) {
        for (std::uint32_t& index : indices) {
            cut.vertices.push_back(whole.vertices[index]);
            index = static_cast<std::uint32_t>(cut.vertices.size()) - 1;
        }
    }
    give_vertex_normals(whole);
    give_vertex_normals(cut);
    for (std::size_t i = 0; i < whole.triangles.size(); ++i) {
        for (std::size_t k = 0; k < 3; ++k) {
            EXPECT_EQ(cut.normals[cut.triangles[i][k]], whole.normals[whole.triangles[i][k]]);
        }
    }
}

// All generators of smooth meshes have normals, unit and outward of most of their triangles; the others are refused.
TEST(VertexNormals, OfGenerators) {
    int smooth = 0;
    for (const Generator& generator : generators()) {
        const std::uint32_t size = std::max(generator.least_size, 3u);
        const std::string mesh = R"("generate": {"mesh": ")" + std::string(generator.name) +
                                 "\", \"size\": " + std::to_string(generator.name == "menger" ? 0 : size) + "}" + asked;
        if (!generator.is_smooth) {
            EXPECT_NE(error_of(mesh), "") << generator.name;
            continue;
        }
        const Scene scene = scene_of(mesh);
        for (const CornerNormals& corners : scene.meshes.at(0)->normals) {
            for (const auto& n : corners.of) {
                const float square = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
                EXPECT_TRUE(square == 0 || std::abs(square - 1) < 1e-6f) << generator.name;
            }
        }
        ++smooth;
    }
    EXPECT_GT(smooth, 6);
}

}  // namespace
}  // namespace pt
