// import as a user calls it: what it prints where, what it writes, and its exit codes.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/cis565_texts.h"
#include "tests/support/command.h"
#include "tests/support/places.h"

namespace pt::test {
namespace {

using Arguments = std::vector<std::string>;

const std::string exact = replaced(with_material("RGB 1 1 1\n"), "ITERATIONS 10\n", "");
const std::string inexact = with_material("RGB 1 1 1\nSPECRGB .5 .5 .5\nSPECEX 25\n");
const std::string wrong = replaced(replaced(exact, "RGB 1 1 1", "RGB 2 1 1"), "FOVY 30", "FOVY x");

// Runs `import box.txt --out box.json` in a folder with that text.
struct Imported {
    Imported(const std::string& text, const Arguments& added) {
        write_text(folder.file("box.txt"), text);
        Arguments arguments{"import", "box.txt", "--out", "box.json"};
        arguments.insert(arguments.end(), added.begin(), added.end());
        command = ptbench(arguments, {.folder = folder.path()});
    }
    nlohmann::json scene() const { return nlohmann::json::parse(content_of(folder.file("box.json"))); }

    TemporaryFolder folder;
    CommandResult command;
};

TEST(ImportCommandTest, AnExactTextIsTalliedAndNoMore) {
    const Imported imported(exact, {});
    EXPECT_EQ(imported.command.exit_code, 0);
    EXPECT_EQ(imported.command.out, "box.txt: 1 object, 1 material, 0 warnings -> box.json\n");
    EXPECT_EQ(imported.command.err, "");
    EXPECT_EQ(imported.scene().at("name"), "plain");
    EXPECT_EQ(imported.folder.content(), (Arguments{"box.json", "box.txt"}));
}

TEST(ImportCommandTest, WarningsAndNotesGoToStandardError) {
    const Imported imported(inexact, {});
    EXPECT_EQ(imported.command.exit_code, 0);
    EXPECT_EQ(imported.command.out, "box.txt: 1 object, 1 material, 1 warning, 1 note -> box.json\n");
    EXPECT_EQ(
        imported.command.err,
        "ptbench: box.txt:4: warning: SPECEX 25 is read as a mix, a mirror with probability 0.5 and else diffuse; "
        "the exponent's size is lost\n"
        "ptbench: box.txt:8: note: ITERATIONS 10 is left out: how many samples a pixel gets is a run's business "
        "(--spp)\n");
    EXPECT_EQ(imported.scene().at("materials").at("material_0").at("type"), "mix");
}

TEST(ImportCommandTest, StrictRefusesWarningsButNotNotes) {
    const Imported refused(inexact, {"--strict"});
    EXPECT_EQ(refused.command.exit_code, 2);
    EXPECT_EQ(refused.command.out, "");
    EXPECT_TRUE(refused.command.err.ends_with("\nptbench: box.txt: 1 warning with --strict; no scene is written\n"))
        << refused.command.err;
    EXPECT_EQ(refused.folder.content(), Arguments{"box.txt"});
    const Imported noted(with_material("RGB 1 1 1\n"), {"--strict"});
    EXPECT_EQ(noted.command.exit_code, 0) << noted.command.err;
    const Imported both(replaced(inexact, "FOVY 30", "FOVY x"), {"--strict"});
    EXPECT_TRUE(
        both.command.err.ends_with("\nptbench: box.txt: 1 problem and 1 warning with --strict; no scene is "
                                   "written\n"))
        << both.command.err;
}

TEST(ImportCommandTest, AllProblemsAreListedAndAnOldSceneStays) {
    const TemporaryFolder folder;
    write_text(folder.file("box.txt"), wrong);
    write_text(folder.file("box.json"), "old");
    const CommandResult result = ptbench({"import", "box.txt", "--out", "box.json"}, {.folder = folder.path()});
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_EQ(result.out, "");
    EXPECT_EQ(
        result.err,
        "ptbench: box.txt:2: found \"RGB 2 1 1\", which makes $.materials.material_0.albedo[0] 2, allowed: a number "
        "from 0 to 1\n"
        "ptbench: box.txt:5: found \"FOVY x\", allowed: FOVY and 1 finite number\n"
        "ptbench: box.txt: 2 problems; no scene is written\n");
    EXPECT_EQ(content_of(folder.file("box.json")), "old");
    EXPECT_EQ(folder.content(), (Arguments{"box.json", "box.txt"}));
}

// An image that lies within the file is written beside the scene; of a file that is refused nothing is.
TEST(ImportCommandTest, AnImageOfTheFileIsWrittenBesideTheScene) {
    const std::string corpus = test::in_source("tests/fuzz/corpus/import_gltf/");
    const TemporaryFolder folder;
    const CommandResult good = ptbench({"import", corpus + "image.gltf", "--out", folder.file("a.json")});
    if (good.err.find("no reader for glTF") != std::string::npos) {
        GTEST_SKIP() << "this build has no reader for glTF";
    }
    EXPECT_EQ(good.exit_code, 0) << good.err;
    EXPECT_EQ(folder.content(), (Arguments{"a.json", "a_image_0.png", "a_mesh_0.ply"}));
    const auto scene = nlohmann::json::parse(content_of(folder.file("a.json")));
    EXPECT_EQ(scene.at("materials").at("shown").at("reflectance").at("image"), "a_image_0.png");
    const CommandResult refused = ptbench({"import", corpus + "hostile_image.gltf", "--out", folder.file("b.json")});
    EXPECT_EQ(refused.exit_code, 2);
    EXPECT_EQ(folder.content().size(), 3u);
}

TEST(ImportCommandTest, ANameIsCheckedAsSceneNamesAre) {
    EXPECT_EQ(Imported(exact, {"--name", "my_box-2"}).scene().at("name"), "my_box-2");
    for (const std::string& bad : {std::string(), std::string("a b"), std::string("a.b"), std::string(65, 'a')}) {
        const Imported imported(exact, {"--name", bad});
        EXPECT_EQ(imported.command.exit_code, 2);
        EXPECT_TRUE(imported.command.err.starts_with("ptbench: --name: argument: found \"")) << imported.command.err;
        EXPECT_NE(imported.command.err.find("allowed: 1 to 64 letters, digits, '_' and '-'"), std::string::npos);
        EXPECT_EQ(std::count(imported.command.err.begin(), imported.command.err.end(), '\n'), 1);
        EXPECT_EQ(imported.folder.content(), Arguments{"box.txt"});
    }
}

TEST(ImportCommandTest, TheTextItselfIsNotOverwritten) {
    const TemporaryFolder folder;
    write_text(folder.file("box.txt"), exact);
    const CommandResult result = ptbench({"import", "box.txt", "--out", "./box.txt"}, {.folder = folder.path()});
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_EQ(result.err, "ptbench: --out: argument: found \"./box.txt\", the file to import, allowed: another file\n");
    EXPECT_EQ(content_of(folder.file("box.txt")), exact);
}

// A mirrored mesh is written anew, and the name that it would have is that of its source. Calls repeat without a trace.
TEST(ImportCommandTest, WhatIsWrittenBesideTheSceneTakesNobodysPlace) {
    const TemporaryFolder folder;
    const std::string triangle =
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 1\nproperty list uchar uint vertex_indices\nend_header\n0 0 0\n1 0 0\n0 2 0\n3 0 1 2\n";
    write_text(folder.file("room_mesh_0.ply"), triangle);
    write_text(folder.file("room.xml"), R"(<scene version="3.0.0"><sensor type="perspective"/><shape type="ply">
        <string name="filename" value="room_mesh_0.ply"/><boolean name="face_normals" value="true"/>
        <transform name="to_world"><scale x="-1"/></transform>
        <bsdf type="twosided"><bsdf type="diffuse"/></bsdf></shape></scene>)");
    const Arguments call{"import", "room.xml", "--out", "room.json"};
    const CommandResult first = ptbench(call, {.folder = folder.path()});
    if (first.err.find("no reader for XML") != std::string::npos) {
        GTEST_SKIP() << "this build has no reader for XML";
    }
    EXPECT_EQ(first.exit_code, 0) << first.err;
    const std::string scene = content_of(folder.file("room.json")), mesh = content_of(folder.file("room_mesh_1.ply"));
    EXPECT_NE(scene.find("\"file\": \"room_mesh_1.ply\""), std::string::npos) << scene;
    EXPECT_EQ(ptbench(call, {.folder = folder.path()}).exit_code, 0);
    EXPECT_EQ(content_of(folder.file("room.json")), scene);
    EXPECT_EQ(content_of(folder.file("room_mesh_0.ply")), triangle);
    EXPECT_EQ(content_of(folder.file("room_mesh_1.ply")), mesh);
    EXPECT_EQ(folder.content(), (Arguments{"room.json", "room.xml", "room_mesh_0.ply", "room_mesh_1.ply"}));
    // A source is none to replace, whatever the call says.
    const CommandResult source =
        ptbench({"import", "room.xml", "--out", "./room_mesh_0.ply", "--overwrite"}, {.folder = folder.path()});
    EXPECT_EQ(source.exit_code, 2);
    EXPECT_EQ(source.err.substr(source.err.find("ptbench: --out")),
              "ptbench: --out: file name: found \"./room_mesh_0.ply\", which this call reads, allowed: another file\n");
    EXPECT_EQ(content_of(folder.file("room_mesh_0.ply")), triangle);
    EXPECT_EQ(folder.content().size(), 4u);
}

TEST(ImportCommandTest, AnotherSceneIsReplacedOnlyWhereTheCallSaysSo) {
    const TemporaryFolder folder;
    write_text(folder.file("box.txt"), exact);
    write_text(folder.file("box.json"), "mine");
    const CommandResult refused = ptbench({"import", "box.txt", "--out", "box.json"}, {.folder = folder.path()});
    EXPECT_EQ(refused.exit_code, 2);
    EXPECT_EQ(refused.err,
              "ptbench: box.json: output file: found a file that is there and holds something else, allowed: "
              "--overwrite, which replaces it, or another --out\n");
    EXPECT_EQ(content_of(folder.file("box.json")), "mine");
    const Arguments replacing{"import", "box.txt", "--out", "box.json", "--overwrite"};
    EXPECT_EQ(ptbench(replacing, {.folder = folder.path()}).exit_code, 0);
    EXPECT_EQ(nlohmann::json::parse(content_of(folder.file("box.json"))).at("name"), "plain");
}

TEST(ImportCommandTest, AFileBeyondTheLimitIsNotRead) {
    const Imported imported(std::string((16 << 20) + 1, '\n'), {});
    EXPECT_EQ(imported.command.exit_code, 2);
    EXPECT_TRUE(imported.command.err.starts_with("ptbench: box.txt: ")) << imported.command.err;
    EXPECT_NE(imported.command.err.find("16 MiB"), std::string::npos) << imported.command.err;
    EXPECT_EQ(imported.folder.content(), Arguments{"box.txt"});
}

}  // namespace
}  // namespace pt::test
