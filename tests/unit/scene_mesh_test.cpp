// Objects of shape "mesh" in scene files: what they share, what they may be made of, and every message of a wrong one.
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "harness/failure.h"
#include "harness/scene/scene.h"
#include "tests/support/command.h"

namespace pt {
namespace {

std::string scene_of(const std::string& objects) {
    return R"({"name": "s", "max_depth": 4, "camera": {"eye": [0, 1, 5], "look_at": [0, 1, 0], "up": [0, 1, 0],
               "vertical_fov_degrees": 40, "resolution": [8, 6]},
               "materials": {"white": {"type": "diffuse", "albedo": [1, 1, 1]}, "glass": {"type": "dielectric", "ior": 1.5},
                             "wax": {"type": "subsurface", "ior": 1.3, "sigma_s": [1, 1, 1]}},
               "objects": [)" +
           objects + "]}";
}

const std::string ball = R"("generate": {"mesh": "icosphere", "size": 0})";

std::string mesh_with(const std::string& keys, const std::string& material = "white") {
    return R"({"shape": "mesh", "material": ")" + material + "\"" + (keys.empty() ? "" : ", " + keys) + "}";
}

std::string error_of(const std::string& object) {
    try {
        parse_scene(scene_of(object), "s.json");
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

TEST(SceneMeshTest, ObjectsOfOneMeshShareIt) {
    const Scene scene = parse_scene(scene_of(mesh_with(ball) + ", " + mesh_with(ball + R"(, "scale": 2)") + ", " +
                                             mesh_with(R"("generate": {"mesh": "icosphere", "size": 1})")),
                                    "s.json");
    ASSERT_EQ(scene.meshes.size(), 2u);
    EXPECT_EQ(scene.objects[0].mesh, scene.objects[1].mesh);
    EXPECT_NE(scene.objects[0].mesh, scene.objects[2].mesh);
    EXPECT_EQ(scene.meshes[scene.objects[0].mesh]->triangles.size(), 20u);
    EXPECT_EQ(scene.meshes[scene.objects[2].mesh]->triangles.size(), 80u);
}

// The scene's hash has the mesh's content, whichever way the file lists it.
TEST(SceneMeshTest, AFileIsReadFromTheScenesFolderAndItsContentCounts) {
    const auto folder = std::filesystem::path(testing::TempDir()) / "scene_mesh_test";
    std::filesystem::create_directories(folder);
    const auto hash_with = [&](const std::string& name, const std::string& lines) {
        std::ofstream(folder / name) << lines;
        const Scene scene =
            parse_scene(scene_of(mesh_with(R"("file": ")" + name + "\"")), (folder / "s.json").string());
        return scene.meshes.at(0)->hash;
    };
    const std::string corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n";
    const std::string hash = hash_with("a.obj", corners + "f 1 2 3\nf 1 3 4\n");
    EXPECT_EQ(hash, hash_with("b.obj", corners + "f 3 4 1\nf 2 3 1\n"));
    EXPECT_NE(hash, hash_with("c.obj", corners + "f 1 2 3\nf 1 4 3\n"));
    std::filesystem::remove_all(folder);
}

TEST(SceneMeshTest, AClosedMeshMayBeGlass) {
    EXPECT_EQ(error_of(mesh_with(ball, "glass")), "");
    EXPECT_EQ(error_of(mesh_with(R"("generate": {"mesh": "needles", "size": 3})", "glass")),
              "s.json: $.objects[0].material: found \"glass\", allowed: on the mesh needles 3, which is not closed: "
              "diffuse, emitter, mirror, mix, rough_conductor or principled without transmission (dielectric, "
              "rough_dielectric and subsurface need a shape with an inside)");
}

TEST(SceneMeshTest, FaultsAreToldWithTheirPlace) {
    EXPECT_EQ(error_of(mesh_with("")),
              "s.json: $.objects[0]: found none of \"file\", \"generate\" and \"vertices\", allowed: one of them, for "
              "a mesh");
    EXPECT_EQ(error_of(mesh_with(ball + R"(, "file": "a.ply")")),
              "s.json: $.objects[0]: found \"file\" and \"generate\", allowed: one of them, for a mesh");
    EXPECT_EQ(error_of(mesh_with(ball, "wax")),
              "s.json: $.objects[0].material: found \"wax\", allowed: on a mesh: diffuse, emitter, mirror, mix, "
              "dielectric, rough_conductor, rough_dielectric or principled (subsurface needs a convex shape)");
    EXPECT_EQ(error_of(mesh_with(R"("generate": {"mesh": "tori", "size": 0})")),
              "s.json: $.objects[0].generate.size: found 0, allowed: a whole number from 1 to 32768 (tori)");
    EXPECT_NE(error_of(mesh_with(R"("generate": {"mesh": "tor", "size": 1})")).find("(did you mean \"tori\"?)"),
              std::string::npos);
    const test::TemporaryFolder folder;
    const std::string other = folder.file("a.stl");
    test::write_text(other, "solid");
    EXPECT_EQ(error_of(mesh_with("\"file\": \"" + other + "\"")),
              other + ": file name: found the ending \".stl\", allowed: .obj, .ply, .glb or .gltf");
    EXPECT_EQ(error_of(R"({"shape": "sphere", "material": "white", )" + ball + "}").find("s.json: $.objects[0]"), 0u);
}

const std::string corners = R"("vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])";

TEST(SceneMeshTest, AMeshMayStandInTheSceneItself) {
    const std::string one = corners + R"(, "triangles": [[0, 1, 2], [0, 2, 3]])";
    const std::string same = corners + R"(, "triangles": [[2, 3, 0], [1, 2, 0]])";
    const std::string other = corners + R"(, "triangles": [[0, 1, 2], [0, 3, 2], [1, 1, 2], [0, 0, 0]])";
    const Scene scene =
        parse_scene(scene_of(mesh_with(one) + ", " + mesh_with(same) + ", " + mesh_with(other)), "s.json");
    ASSERT_EQ(scene.meshes.size(), 2u);
    EXPECT_EQ(scene.objects[0].mesh, scene.objects[1].mesh);
    EXPECT_EQ(scene.meshes[scene.objects[0].mesh]->degenerate_left_out, 0u);
    EXPECT_EQ(scene.meshes[scene.objects[2].mesh]->triangles.size(), 2u);
    EXPECT_EQ(scene.meshes[scene.objects[2].mesh]->degenerate_left_out, 2u);
}

TEST(SceneMeshTest, AFileThatIsMissingIsToldWithTheLineThatNamesIt) {
    const test::TemporaryFolder folder;
    const std::string file = folder.file("s.json");
    const auto error = [&](const std::string& text) {
        test::write_text(file, text);
        try {
            (void)load_scene(file);
        } catch (const InputError& caught) {
            return std::string(caught.what());
        }
        return std::string();
    };
    const std::string allowed = "), allowed: a file, by its path from the scene's folder";
    EXPECT_EQ(
        error(scene_of("\n" + mesh_with(R"("file": "none.obj")"))),
        file + ":6: $.objects[0].file: found \"none.obj\", which is no file (" + folder.file("none.obj") + allowed);
    std::filesystem::create_directory(folder.file("folder.obj"));
    EXPECT_NE(error(scene_of(mesh_with(R"("file": "folder.obj")"))).find("which is a folder"), std::string::npos);
    // Without a file of its own, a scene has no lines.
    EXPECT_EQ(error_of(mesh_with(R"("file": "none.obj")")).find("s.json: $.objects[0].file: found \"none.obj\", "), 0u);
}

TEST(SceneMeshTest, FaultsOfAMeshInTheSceneAreToldWithTheirPlace) {
    EXPECT_EQ(error_of(mesh_with(corners + R"(, "triangles": [[0, 1, 4]])")),
              "s.json: $.objects[0].triangles[0][2]: found 4, allowed: a vertex, counted from 0: a whole number from 0 "
              "to 3");
    EXPECT_EQ(error_of(mesh_with(R"("vertices": [[0, 0, 1e39]], "triangles": [])")),
              "s.json: $.objects[0].vertices[0][2]: found 1e+39, allowed: a number of single precision");
    EXPECT_EQ(error_of(mesh_with(corners + R"(, "triangles": [[0, 1, 1]])")),
              "s.json: $.objects[0].triangles: mesh: found 1 triangle without area and no other, allowed: at least "
              "one triangle that has an area");
    EXPECT_NE(error_of(mesh_with(corners + R"(, "triangles": [[0, 1]])")).find("allowed: [i, j, k]"),
              std::string::npos);
    EXPECT_NE(error_of(mesh_with(corners)).find("allowed: \"vertices\" with \"triangles\", or neither"),
              std::string::npos);
    EXPECT_NE(error_of(mesh_with(corners + R"(, "triangles": [[0, 1, 2]], "file": "a.ply")"))
                  .find("found \"file\" and \"vertices\""),
              std::string::npos);
}

// The teapot reaches further than its scale: what float cannot hold is refused, as of other shapes.
TEST(SceneMeshTest, AMeshBeyondFloatIsRefused) {
    const std::string teapot = R"("generate": {"mesh": "teapot", "size": 2}, "scale": )";
    EXPECT_EQ(error_of(mesh_with(teapot + "1e17")), "");
    EXPECT_EQ(
        error_of(mesh_with(teapot + "1e18")),
        "s.json: $.objects[0]: found the mesh teapot 2 reaching beyond 1e18, allowed: a mesh, a place and a scale "
        "that keep it within -1e18 to 1e18");
}

}  // namespace
}  // namespace pt
