// The JSON format of CIS 565: what is its own, and that the rest is read as the text format's lines are.
#include "harness/interchange/import_course_json.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "harness/interchange/import_cis565.h"
#include "harness/interchange/import_scene.h"
#include "harness/scene/json_lines.h"
#include "harness/scene/scene.h"
#include "tests/support/cis565_texts.h"
#include "tests/support/command.h"
#include "tests/support/places.h"

namespace pt {
namespace {

using test::replaced;
using Lines = std::vector<std::string>;

const std::string plain = R"({
    "Materials":
    {
        "light": {"TYPE": "Emitting", "RGB": [1.0, 0.5, 0.25], "EMITTANCE": 4.0},
        "grey":
        {
            "TYPE": "Diffuse",
            "RGB": [0.5, 0.5, 0.5]
        }
    },
    "Camera":
    {
        "RES": [40, 30],
        "FOVY": 30.0,
        "ITERATIONS": 10,
        "DEPTH": 5,
        "FILE": "plain",
        "EYE": [1.0, 2.0, 3.0],
        "LOOKAT": [1.0, 2.0, 0.0],
        "UP": [0.0, 1.0, 0.0]
    },
    "Objects":
    [
        {"TYPE": "cube", "MATERIAL": "light", "TRANS": [0, 1.5, 0], "ROTAT": [0, 0, 0], "SCALE": [3, 0.25, 3]},
        {"TYPE": "sphere", "MATERIAL": "grey", "TRANS": [0, 0, 0], "ROTAT": [0, 90, 0], "SCALE": [1, 1, 1]}
    ]
}
)";

ImportResult result_of(const std::string& text) {
    return import_course_json({.text = text, .file = "a folder/box.json", .out = "", .name = ""});
}

Lines problems_of(const std::string& text) { return result_of(text).problems.messages("box.json", ""); }
Lines warnings_of(const std::string& text) { return result_of(text).warnings.messages("box.json", "warning"); }

Scene scene_of(const std::string& text) {
    const ImportResult result = result_of(text);
    EXPECT_EQ(result.problems.messages("box.json", ""), Lines());
    return parse_scene(result.json, "scene.json");
}

std::string with_grey(const std::string& material) {
    return replaced(plain, "\"TYPE\": \"Diffuse\",\n            \"RGB\": [0.5, 0.5, 0.5]", material);
}

SceneMaterial grey_of(const std::string& material) { return scene_of(with_grey(material)).materials.at(0); }

TEST(ImportCourseJson, ATextureIsTheImageThatIsShown) {
    const std::string tiles = test::in_source("scenes/textures/tiles.png");
    const std::string text = replaced(plain, "\"RGB\": [0.5, 0.5, 0.5]", "\"TEXTURE\": \"" + tiles + "\"");
    EXPECT_NE(scene_of(text).materials.at(0).texture, nullptr);
    const Lines warnings = warnings_of(text);
    ASSERT_EQ(warnings.size(), 1u);
    EXPECT_TRUE(warnings[0].starts_with("box.json:8: warning: $.Materials.grey.TEXTURE ")) << warnings[0];
    EXPECT_EQ(problems_of(replaced(plain, "\"RGB\": [0.5, 0.5, 0.5]", "\"TEXTURE\": \"not_there.png\"")),
              Lines{"box.json:8: found \"$.Materials.grey.TEXTURE not_there.png\", allowed: an image .png or .jpg that "
                    "is there, "
                    "beside this file or in a folder above it"});
}

TEST(ImportCourseJson, AScene) {
    const ImportResult result = result_of(plain);
    EXPECT_EQ(result.json, R"({
  "name": "plain",
  "description": "Imported from box.json.",
  "max_depth": 5,
  "camera": {"eye": [1, 2, 3], "look_at": [1, 2, 0], "up": [0, 1, 0], "vertical_fov_degrees": 60, "resolution": [40, 30]},
  "materials": {
    "grey": {"type": "diffuse", "albedo": [0.5, 0.5, 0.5]},
    "light": {"type": "emitter", "radiance": [4, 2, 1]}
  },
  "objects": [
    {"shape": "box", "material": "light", "translate": [0, 1.5, 0], "scale": [3, 0.25, 3]},
    {"shape": "sphere", "material": "grey", "rotate_degrees": [0, 90, 0]}
  ]
}
)");
    EXPECT_EQ(result.objects, 2u);
    EXPECT_EQ(result.materials, 2u);
    EXPECT_EQ(result.warnings.count(), 0u);
    EXPECT_EQ(result.notes.messages("box.json", "note"),
              Lines{"box.json:15: note: $.Camera.ITERATIONS 10 is left out: how many samples a pixel gets is a run's "
                    "business (--spp)"});
}

TEST(ImportCourseJson, TheFilesOwnNameStandsForFile) {
    EXPECT_EQ(scene_of(replaced(plain, "        \"FILE\": \"plain\",\n", "")).name, "box");
    EXPECT_EQ(
        parse_scene(import_course_json({.text = plain, .file = "box.json", .out = "", .name = "mine"}).json, "s").name,
        "mine");
}

TEST(ImportCourseJson, Types) {
    const auto type_of = [](const std::string& material) { return grey_of(material).type; };
    EXPECT_EQ(type_of(R"("TYPE": "Specular", "RGB": [1, 1, 1], "ROUGHNESS": 0.0)"), MaterialType::mirror);
    EXPECT_EQ(type_of(R"("TYPE": "Specular", "RGB": [1, 1, 1], "ROUGHNESS": 0.5)"), MaterialType::rough_conductor);
    EXPECT_EQ(type_of(R"("TYPE": "Specular", "RGB": [1, 1, 1], "HAS_REFRACTIVE": 1, "IOR": 1.5)"),
              MaterialType::dielectric);
    EXPECT_EQ(type_of(R"("TYPE": "Refractive", "RGB": [1, 1, 1], "IOR": 1.5)"), MaterialType::dielectric);
    EXPECT_EQ(type_of(R"("TYPE": "Glass", "RGB": [1, 1, 1], "IOR": 1.5, "ROUGHNESS": 0.5)"),
              MaterialType::rough_dielectric);
    EXPECT_EQ(type_of(R"("TYPE": "Pbr", "RGB": [1, 1, 1], "METALLIC": 1.0, "ROUGHNESS": 0.5)"),
              MaterialType::rough_conductor);
    EXPECT_EQ(type_of(R"("TYPE": "Pbr", "RGB": [1, 1, 1], "METALLIC": 0.0, "ROUGHNESS": 1.0)"), MaterialType::diffuse);
    EXPECT_EQ(type_of(R"("TYPE": "Disney", "RGB": [1, 1, 1], "METALLIC": 0.0, "TRANSMISSION": 1.0, "IOR": 1.5)"),
              MaterialType::dielectric);
    EXPECT_EQ(type_of(R"("TYPE": "Subsurface", "RGB": [1, 1, 1], "SIGMA_A": [0, 0, 0], "SIGMA_S": [1, 1, 1])"),
              MaterialType::subsurface);
}

TEST(ImportCourseJson, WhatATypeLosesOrAddsIsAWarningOfItsLine) {
    EXPECT_EQ(
        warnings_of(with_grey(R"("TYPE": "Glass", "RGB": [1, 1, 1])")),
        Lines{"box.json:5: warning: $.Materials.grey has no index of refraction: \"grey\" is a dielectric of index "
              "1.5"});
    EXPECT_EQ(
        warnings_of(with_grey("\"TYPE\": \"Pbr\", \"RGB\": [1, 1, 1],\n\"METALLIC\": 0.25,\n\"ROUGHNESS\": 0.5")),
        (Lines{
            "box.json:8: warning: $.Materials.grey.METALLIC 0.25 is read as 0: no metal",
            "box.json:9: warning: $.Materials.grey.ROUGHNESS 0.5 is not used: \"grey\" is diffuse, and the gloss over "
            "it is lost"}));
    EXPECT_EQ(warnings_of(with_grey(R"("TYPE": "Specular", "RGB": [1, 1, 1], "ROUGHNESS": 0.5)")),
              Lines{"box.json:7: warning: $.Materials.grey.ROUGHNESS 0.5 is read as GGX of the width 0.25, its square: "
                    "programs differ"});
}

TEST(ImportCourseJson, LensesInTheirSpellings) {
    for (const std::string lens : {R"("LENSRADIUS": 0.2, "FOCALLENGTH": 4)", R"("LENRADIUS": 0.2, "FOCALLENGTH": 4.0)",
                                   R"("APERTURE_RADIUS": 0.2, "FOCAL_DISTANCE": 4)", R"("RADIUS": 0.2, "FOCALDIST": 4)",
                                   R"("APERTURE": 0.2, "FOCUS_DIS": 4)"}) {
        const SceneCamera camera = scene_of(replaced(plain, "\"DEPTH\"", lens + ", \"DEPTH\"")).camera;
        EXPECT_EQ(camera.aperture_radius, 0.2) << lens;
        EXPECT_EQ(camera.focus_distance, 4) << lens;
    }
}

TEST(ImportCourseJson, RectanglesAndTrianglesAreMeshes) {
    const std::string cube = R"({"TYPE": "cube", "MATERIAL": "light",)";
    EXPECT_EQ(scene_of(replaced(plain, cube, R"({"TYPE": "rect", "MATERIAL": "light",)")).meshes.size(), 1u);
    EXPECT_EQ(
        scene_of(replaced(plain, cube,
                          R"({"TYPE": "mesh", "VERTICES": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "MATERIAL": "light",)"))
            .meshes.size(),
        1u);
}

TEST(ImportCourseJson, MeshesByFileAndByTheirNames) {
    const test::TemporaryFolder folder;
    std::filesystem::create_directories(folder.path() / "scenes");
    std::filesystem::create_directories(folder.path() / "out");
    std::filesystem::create_directories(folder.path() / "resources/one/obj");
    test::write_text(folder.file("resources/one/obj/one.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    const std::string cube = R"({"TYPE": "cube", "MATERIAL": "light",)", before = R"("Materials":)";
    for (const std::string mesh : {R"("TYPE": "mesh", "FILE": "../resources/one/obj/one.obj")",
                                   R"("TYPE": "obj_file", "OBJFILE": "one")", R"("TYPE": "mesh", "MESH": "first")",
                                   R"("TYPE": "gltf", "PATH": "D:\\course\\resources\\one\\obj\\one.obj")"}) {
        std::string text = replaced(plain, cube, "{" + mesh + R"(, "MATERIAL": "light",)");
        text = replaced(text, before, R"("Meshes": {"first": "./one.obj"}, )" + before);
        const ImportResult result = import_course_json(
            {.text = text, .file = folder.file("scenes/a.json"), .out = folder.file("out/b.json"), .name = ""});
        EXPECT_EQ(result.problems.messages("a.json", ""), Lines()) << mesh;
        EXPECT_NE(result.json.find("\"file\": \"../resources/one/obj/one.obj\""), std::string::npos) << result.json;
    }
}

TEST(ImportCourseJson, EnvironmentsAreImagesWithAWarning) {
    const std::string sky = test::in_source("scenes/environments/sky.hdr");
    for (const std::string& said :
         {R"("EnvMap": ")" + sky + "\"", R"("Background": {"type": "skybox", "path": ")" + sky + "\"}"}) {
        const std::string text = replaced(plain, "\"Materials\":", said + ", \"Materials\":");
        const ImportResult result = import_course_json({.text = text, .file = "box.json", .out = "", .name = ""});
        EXPECT_EQ(result.problems.messages("a.json", ""), Lines()) << said;
        EXPECT_EQ(result.warnings.count(), 1u);
        const Scene scene = parse_scene(result.json, "box.json");
        ASSERT_NE(scene.environment_map, nullptr);
        EXPECT_EQ(scene.environment_map->rotation_degrees, 90);
        EXPECT_EQ(scene.environment_map->image.width, 64u);
    }
    const std::string none = replaced(plain, "\"Materials\":", "\"EnvMap\": null, \"Materials\":");
    EXPECT_EQ(problems_of(none), Lines());
}

TEST(ImportCourseJson, AllProblemsAreListedWithTheirLines) {
    std::string text =
        replaced(plain, "\"Materials\":", "\"Environment\": {\"FILE\": \"sky.hdr\"},\n    \"Materials\":");
    text = replaced(text, "[1.0, 0.5, 0.25]", "[1.0, 0.5]");
    text = replaced(text, "\"Diffuse\"", "\"Velvet\"");
    text = replaced(text, "\"FOVY\": 30.0", "\"FOVY\": 90.0");
    text = replaced(text, "\"cube\"", "\"torus\"");
    text = replaced(text, "\"MATERIAL\": \"grey\"", "\"MATERIAL\": \"gray\", \"SHINE\": 2");
    EXPECT_EQ(
        problems_of(text),
        (Lines{
            "box.json:2: found \"$.Environment sky.hdr\", allowed: an image .hdr or .exr that is there, beside this "
            "file "
            "or in a folder above it",
            "box.json:5: found \"$.Materials.light.RGB 1.0 0.5\", allowed: $.Materials.light.RGB and 3 finite "
            "numbers",
            "box.json:8: found \"$.Materials.grey.TYPE Velvet\", allowed: Diffuse, Emitting, Specular, Mirror, "
            "Metal, Refractive, Glass, PBR, Microfacet, Disney, Plastic or Subsurface",
            "box.json:15: found \"$.Camera.FOVY 90.0\", which makes $.camera.vertical_fov_degrees 180, allowed: an "
            "angle from 1e-6 to 179.999 degrees",
            "box.json:25: found \"$.Objects[0].TYPE torus\", allowed: no procedural shape or pattern (scene files "
            "have none)",
            "box.json:25: found $.Objects[0] without a shape, allowed: with cube or sphere",
            "box.json:26: found \"$.Objects[1].SHINE 2\", allowed: in OBJECT: cube, sphere, rect, mesh, material, "
            "TRANS, ROTAT, SCALE, VEL, FILE",
        }));
}

// std::unordered_map<std::string, uint32_t> has 0 for a key that is new, and materials come in the order of their
// names.
TEST(ImportCourseJson, AMaterialThatIsNotThereIsTheFirstAsInTheCoursesLoader) {
    const std::string text = replaced(plain, "\"MATERIAL\": \"light\"", "\"MATERIAL\": \"lamp\"");
    const Scene scene = scene_of(text);
    EXPECT_EQ(scene.materials.at(scene.objects.at(0).material).name, "grey");
    EXPECT_EQ(warnings_of(text),
              Lines{"box.json:24: warning: $.Objects[0].MATERIAL lamp is none of $.Materials: read as \"grey\", the "
                    "first by its name, which the course's loader takes then"});
    EXPECT_EQ(problems_of(replaced(plain, "\"MATERIAL\": \"light\"", "\"MATERIAL\": [1, 2]")),
              Lines{"box.json:24: found \"$.Objects[0].MATERIAL 1 2\", allowed: the name of one of $.Materials"});
}

TEST(ImportCourseJson, ATypeThatNamesAMaterialIsBlackAsInTheCoursesLoader) {
    const std::string lines = "\"TYPE\": \"light\", \"RGB\": [0.5, 0.5, 0.5], \"IOR\": 1.5";
    EXPECT_EQ(grey_of(lines).type, MaterialType::emitter);  // a type by that name comes first
    const std::string named = replaced(with_grey(replaced(lines, "light", "lamp_1")), "\"light\": {", "\"lamp_1\": {");
    const std::string text = replaced(named, "\"MATERIAL\": \"light\"", "\"MATERIAL\": \"lamp_1\"");
    const SceneMaterial grey = scene_of(text).materials.at(0);
    EXPECT_EQ(grey.type, MaterialType::diffuse);
    EXPECT_EQ(grey.albedo, Vec3d(0.0));
    EXPECT_EQ(warnings_of(text),
              Lines{"box.json:7: warning: $.Materials.grey.TYPE lamp_1 is the name of a material and no type: read as "
                    "black, as the course's loader leaves it"});
}

TEST(ImportCourseJson, GlassInItsSpellings) {
    for (const std::string lines : {R"("TYPE": "Specular Transmissive", "RGB": [1, 1, 1], "ETA": 1.25)",
                                    R"("TYPE": "Refractive", "RGB": [1, 1, 1], "REFRACTION": 1.25)",
                                    R"("TYPE": "Refract", "RGB": [1, 1, 1], "REFRACT": 1, "IOR": 1.25)"}) {
        const SceneMaterial glass = grey_of(lines);
        EXPECT_EQ(glass.type, MaterialType::dielectric) << lines;
        EXPECT_EQ(glass.ior, 1.25) << lines;
    }
}

TEST(ImportCourseJson, ABackgroundIsTheEnvironment) {
    const std::string text = replaced(plain, "\"Materials\":", "\"Background_Color\": [1, 2, 3],\n    \"Materials\":");
    EXPECT_EQ(scene_of(text).environment, Vec3d(1, 2, 3));
}

TEST(ImportCourseJson, WhatIsNoSceneOfTheCourse) {
    EXPECT_EQ(problems_of("[1]"), Lines{"box.json: found [1], allowed: an object with Materials, Camera and Objects"});
    EXPECT_EQ(problems_of("{}"),
              (Lines{"box.json: found no \"Materials\", allowed: one", "box.json: found no \"Camera\", allowed: one",
                     "box.json: found no \"Objects\", allowed: one"}));
    EXPECT_EQ(problems_of(R"({"camera": 1, "materials": 2, "objects": 3})"),
              Lines{"box.json: found a scene file of ptbench, allowed: a scene of CIS 565 (this one needs no import)"});
    EXPECT_EQ(problems_of("{\"a\": 1,}").size(), 1u);
}

// One importer reads both: what a text says and its JSON are one scene.
TEST(ImportCourseJson, IsReadAsTheTextIs) {
    const std::string text = "MATERIAL 0\nRGB .5 .5 .5\nMATERIAL 1\nRGB 1 .5 .25\nEMITTANCE 4\n" + test::plain_camera +
                             "OBJECT 0\ncube\nmaterial 1\nTRANS 0 1.5 0\nROTAT 0 0 0\nSCALE 3 .25 3\nOBJECT "
                             "1\nsphere\nmaterial 0\nTRANS 0 0 "
                             "0\nROTAT 0 90 0\nSCALE 1 1 1\n";
    std::string named = import_cis565_scene(text, "box.json").json;
    for (const auto& [number, name] : {std::pair("material_0", "grey"), std::pair("material_1", "light")}) {
        named = replaced(replaced(named, number, name), number, name);
    }
    EXPECT_EQ(named, result_of(plain).json);
}

TEST(ImportScene, TheFormatGoesByNameAndElseByContent) {
    const auto format = [](const std::string& file, const std::string& text) {
        return std::string(import_format_of({.text = text, .file = file, .out = "", .name = ""}).name);
    };
    EXPECT_EQ(format("a.txt", "{"), "CIS 565 text");
    EXPECT_EQ(format("a.JSON", "MATERIAL 0"), "CIS 565 JSON");
    EXPECT_EQ(format("a.scene", "\n {"), "CIS 565 JSON");
    EXPECT_EQ(format("a", "MATERIAL 0"), "CIS 565 text");
}

TEST(LinesOfJson, KeysAndObjectsInArraysHaveTheirs) {
    const auto lines = lines_of_json("{\n\"a\": [1, {\n\"b\\\"\": \"xy\"}, {}],\n\n\"c\": {\"d\": [[{\"e\": 1}]]}}");
    EXPECT_EQ(lines.at("$"), 1u);
    EXPECT_EQ(lines.at("$.a"), 2u);
    EXPECT_EQ(lines.at("$.a[1]"), 2u);
    EXPECT_EQ(lines.at("$.a[1].b\""), 3u);
    EXPECT_EQ(lines.at("$.a[2]"), 3u);
    EXPECT_EQ(lines.at("$.c.d[0][0].e"), 5u);
}

}  // namespace
}  // namespace pt
