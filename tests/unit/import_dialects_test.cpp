// The dialects of the CIS 565 text format: what students' programs added to it, called otherwise or switch off.
#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/cis565_texts.h"
#include "tests/support/command.h"
#include "tests/support/places.h"

namespace pt {
namespace {

using test::plain_object, test::problems_of, test::replaced, test::with_material;
using Lines = std::vector<std::string>;

const std::string white = with_material("RGB 1 1 1\n");

ImportResult result_of(const std::string& text) { return import_cis565_scene(text, "cis565.txt"); }

Scene scene_of(const std::string& text) {
    const ImportResult result = result_of(text);
    EXPECT_EQ(result.problems.messages("cis565.txt", ""), Lines());
    return parse_scene(result.json, "scene.json");
}

Lines warnings_of(const std::string& text) { return result_of(text).warnings.messages("cis565.txt", "warning"); }

std::string with_camera(const std::string& lines) { return replaced(white, "UP 0 1 0\n", "UP 0 1 0\n" + lines); }

SceneMaterial material_of(const std::string& lines) { return scene_of(with_material(lines)).materials.at(0); }

TEST(ImportDialects, WhatIsOffChangesNothing) {
    const std::string plain = result_of(white).json;
    for (const std::string lines : {"FOCALDIST 0\nLENSRADIUS 0\n", "DOF 0 10.5\n", "SPP 1\n", "TEXTURE\n", "frame 0\n",
                                    "AA ON\n", "LENS 0\nFOCAL 3\n"}) {
        EXPECT_EQ(result_of(with_camera(lines)).json, plain) << lines;
        EXPECT_EQ(warnings_of(with_camera(lines)), Lines()) << lines;
    }
    for (const std::string lines :
         {"TEXTURE NULL\nNORMAL_MAP NULL\n", "usingProcTex 0\nProcTexNum 2\nisSubSurface 0\n", "FRESNELPOW 5\n",
          "SCATTER 0\nABSCOEFF 0 0 0\nRSCTCOEFF 0\n", "ROUGHNESS 0\nMETALLIC 0\n"}) {
        const std::string text = with_material("RGB 1 1 1\n" + lines);
        EXPECT_EQ(result_of(text).json, plain) << lines;
        EXPECT_EQ(warnings_of(text), Lines()) << lines;
    }
}

TEST(ImportDialects, AnUnknownWordThatIsOffIsNoted) {
    const ImportResult result = result_of(with_material("RGB 1 1 1\nIRIDESCENCE 0 0 0\n"));
    EXPECT_EQ(result.notes.listed().front().text, "IRIDESCENCE 0 0 0 is left out: no known key, and off");
    EXPECT_EQ(result.json, result_of(white).json);
}

TEST(ImportDialects, WhatIsOnAndHasNoPlaceIsRefusedOrWarnedOf) {
    const std::string at = "cis565.txt:3: found ";
    EXPECT_EQ(problems_of(with_material("RGB 1 1 1\nBUMP_MAP wood.jpg\n")),
              at + "\"BUMP_MAP wood.jpg\", allowed: no image here (TEXTURE of a material is read; no normal, bump or "
                   "roughness map is)\n");
    EXPECT_EQ(problems_of(with_material("RGB 1 1 1\nusingProcTex 2\n")),
              at + "\"usingProcTex 2\", allowed: no procedural shape or pattern (scene files have none)\n");
    EXPECT_EQ(warnings_of(with_material("RGB 1 1 1\nFRESNELPOW 3\n")),
              Lines{"cis565.txt:3: warning: FRESNELPOW 3 is lost: scene files have nothing like it"});
}

const std::string tiles = test::in_source("scenes/textures/tiles.png");
const std::string unsaid = " is read as sRGB with v upwards; formats of the course do not say";

// In each spelling; the hash of the texels is that of the image itself.
TEST(ImportDialects, ATextureIsTheImageThatIsShown) {
    const Scene shipped = load_scene(test::in_source("scenes/textures/textures.json"));
    for (const std::string word : {"TEXTURE", "DIFFUSE_MAP", "DIFFUSE_TEXTURE", "DIFFUSE", "D_PATH", "ALBEDO_MAP"}) {
        for (const std::string colour : {"RGB 1 1 1\n", "RGB 0 0 0\n", "\n"}) {
            std::string lines = colour;
            lines.append(word).append(" ").append(tiles).append("\n");
            const SceneMaterial material = material_of(lines);
            ASSERT_NE(material.texture, nullptr) << lines;
            EXPECT_EQ(material.type, MaterialType::diffuse);
            EXPECT_EQ(material.texture->hash, shipped.materials.back().texture->hash) << lines;
            const Lines warnings = warnings_of(with_material(lines));
            ASSERT_EQ(warnings.size(), 1u) << lines;
            EXPECT_TRUE(warnings[0].ends_with(unsaid)) << warnings[0];
        }
    }
}

TEST(ImportDialects, ATextureOfMirrorsMetalAndMixes) {
    const std::string texture = "TEXTURE " + tiles + "\n";
    EXPECT_NE(material_of("RGB 1 1 1\nREFL 1\n" + texture).texture, nullptr);
    EXPECT_EQ(material_of("REFL 1\n" + texture).type, MaterialType::mirror);
    EXPECT_EQ(material_of("REFL 1\nROUGHNESS .5\n" + texture).type, MaterialType::rough_conductor);
    const SceneMaterial mix = material_of("RGB .5 .5 .5\nSPECEX 9\nSPECRGB .25 .5 1\n" + texture);
    EXPECT_EQ(mix.type, MaterialType::mix);
    EXPECT_NE(mix.texture, nullptr);
    EXPECT_EQ(mix.reflectance, Vec3d(.25, .5, 1));
    EXPECT_EQ(material_of("SPECEX 9\n" + texture).reflectance, Vec3d(1.0));
}

TEST(ImportDialects, AColourThatAnImageStandsForIsTold) {
    const Lines warnings = warnings_of(with_material("RGB .5 1 1\nTEXTURE " + tiles + "\n"));
    ASSERT_EQ(warnings.size(), 2u);
    EXPECT_EQ(warnings[0], "cis565.txt:2: warning: RGB .5 1 1 is not used: material 0 is diffuse, and shows " + tiles);
}

TEST(ImportDialects, AnImageIsFoundAsAMeshIs) {
    const test::TemporaryFolder folder;
    std::filesystem::create_directories(folder.path() / "project" / "scenes");
    std::filesystem::create_directories(folder.path() / "project" / "my images");
    std::filesystem::copy(tiles, folder.path() / "project" / "my images" / "wood.png");
    for (const std::string named : {"../my images/wood.png", "C:\\course\\my images\\wood.png", "elsewhere/wood.png"}) {
        std::string lines = "RGB 1 1 1\nTEXTURE ";
        lines.append(named).append("\n");
        const ImportResult result = import_cis565({.text = with_material(lines),
                                                   .file = folder.file("project/scenes/a.txt"),
                                                   .out = folder.file("a.json"),
                                                   .name = ""});
        EXPECT_EQ(result.problems.messages("f", ""), Lines()) << named;
        EXPECT_NE(result.json.find("{\"image\": \"project/my images/wood.png\"}"), std::string::npos) << result.json;
    }
}

// Somewhere in the project, as a camera called it.
TEST(ImportDialects, AnImageMayEndInCapitals) {
    const test::TemporaryFolder folder;
    std::filesystem::create_directories(folder.path() / "project" / "scenes");
    std::filesystem::create_directories(folder.path() / "project" / "photos");
    std::filesystem::copy(tiles, folder.path() / "project" / "photos" / "154.PNG");
    const ImportResult result = import_cis565({.text = with_material("RGB 1 1 1\nTEXTURE 154.PNG\n"),
                                               .file = folder.file("project/scenes/a.txt"),
                                               .out = folder.file("a.json"),
                                               .name = ""});
    EXPECT_EQ(result.problems.messages("f", ""), Lines());
    EXPECT_NE(result.json.find("{\"image\": \"project/photos/154.PNG\"}"), std::string::npos) << result.json;
}

TEST(ImportDialects, ImagesThatCannotBeShownAreRefused) {
    const std::string at = "cis565.txt:3: found ", there =
                                                       "an image .png or .jpg that is there, beside this file or in "
                                                       "a folder above it\n";
    EXPECT_EQ(problems_of(with_material("RGB 1 1 1\nTEXTURE wood.jpg\n")),
              at + "\"TEXTURE wood.jpg\", allowed: " + there);
    EXPECT_EQ(problems_of(with_material("RGB 1 1 1\nTEXTURE 1\n")), at + "\"TEXTURE 1\", allowed: " + there);
    const test::TemporaryFolder folder;
    test::write_text(folder.file("a.bmp"), "BM");
    test::write_text(folder.file("a.png"), "no image");
    EXPECT_NE(
        problems_of(with_material("RGB 1 1 1\nTEXTURE " + folder.file("a.bmp") + "\n"))
            .find("found the ending \".bmp\", allowed: .png, .jpg or .jpeg, allowed: an image that can be read\n"),
        std::string::npos);
    EXPECT_NE(
        problems_of(with_material("RGB 1 1 1\nTEXTURE " + folder.file("a.png") + "\n")).find("no header of either"),
        std::string::npos);
    const std::string texture = "TEXTURE " + tiles + "\n";
    for (const std::string lines :
         {"RGB 1 1 1\nEMITTANCE 1\n", "RGB 1 1 1\nSIGMAS 1 1 1\n", "RGB 1 1 1\nREFR 1\nREFRIOR 1.5\n"}) {
        EXPECT_TRUE(
            problems_of(with_material(lines + texture))
                .ends_with("an image on a diffuse surface, a mirror, metal or a mix, which material 0 is not\n"))
            << lines;
    }
}

TEST(ImportDialects, AMeshWithoutCoordinatesShowsNoImage) {
    const test::TemporaryFolder folder;
    test::write_text(folder.file("a.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    test::write_text(folder.file("b.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n");
    const std::string text = with_material("RGB 1 1 1\nTEXTURE " + tiles + "\n");
    const std::string bare = replaced(text, "cube\n", "mesh\n" + folder.file("a.obj") + "\n");
    EXPECT_NE(problems_of(bare).find("cis565.txt:16: found \"material 0\", which makes $.objects[0].material "),
              std::string::npos)
        << problems_of(bare);
    EXPECT_NE(problems_of(bare).find("a.obj, which has no texture coordinates: a material without an image"),
              std::string::npos);
    EXPECT_EQ(problems_of(replaced(text, "cube\n", "mesh\n" + folder.file("b.obj") + "\n")), "");
}

TEST(ImportDialects, ABackgroundIsTheEnvironment) {
    EXPECT_EQ(scene_of("BACKGROUND_COLOR 0.1 0.25 0.5\n\n" + white).environment, Vec3d(0.1, 0.25, 0.5));
    EXPECT_EQ(scene_of(white + "\nBACKGROUND_COLOR 1 2 3\n").environment, Vec3d(1, 2, 3));
    EXPECT_EQ(warnings_of("BACKGROUND_COLOR 1 2 3\n" + white), Lines());
    EXPECT_EQ(result_of("BACKGROUND_COLOR 0 0 0\n" + white).json, result_of(white).json);
    EXPECT_EQ(problems_of("BACKGROUND_COLOR 1 2\n" + white),
              "cis565.txt:1: found \"BACKGROUND_COLOR 1 2\", allowed: BACKGROUND_COLOR and 3 finite numbers\n");
    EXPECT_EQ(problems_of("BACKGROUND_COLOR -1 2 3\n" + white).substr(0, 76),
              "cis565.txt:1: found \"BACKGROUND_COLOR -1 2 3\", which makes $.environment[0] ");
    EXPECT_EQ(problems_of("BACKGROUND_COLOR 1 1 1\nBACKGROUND_COLOR 1 1 1\n" + white),
              "cis565.txt:2: found \"BACKGROUND_COLOR 1 1 1\", allowed: BACKGROUND_COLOR once; line 1 has it\n");
}

TEST(ImportDialects, TheFileOfThePictureNamesTheScene) {
    for (const std::string file : {"../oops/box.png", "box.png", "..\\oops\\box", "../oops/box"}) {
        const ImportResult result = result_of(replaced(white, "FILE plain", "FILE " + file));
        EXPECT_NE(result.json.find("\"name\": \"box\""), std::string::npos) << file << result.json;
        EXPECT_EQ(result.notes.listed().back().text, "FILE " + file + ": the scene is called box");
    }
}

TEST(ImportDialects, CommentsMayStandBehindALine) {
    EXPECT_EQ(result_of(replaced(white, "RGB 1 1 1", "RGB 1 1 1 // white")).json, result_of(white).json);
    EXPECT_EQ(result_of(replaced(white, "DEPTH 5", "DEPTH 5 # bounces")).json, result_of(white).json);
}

// The rays of the programs start at a point of a disk of that radius and meet where the plain ray is the distance of
// focus ahead, along the view axis (`t = focalDistance / dot(direction, view)`): scene files' own lens.
TEST(ImportDialects, LensesInTheirSpellings) {
    for (const std::string lines :
         {"LENSRADIUS .2\nFOCALDIST 4\n", "LENSR .2\nFOCALD 4\n", "LENS .2\nFOCAL 4\n", "DOF .2 4\n",
          "LENS_RADIUS .2\nFOCAL_DISTANCE 4\n", "LENSRAD .2\nFOCALLENGTH 4\n", "LRADIUS .2\nFLENGTH 4\n"}) {
        const SceneCamera camera = scene_of(with_camera(lines)).camera;
        EXPECT_EQ(camera.aperture_radius, 0.2) << lines;
        EXPECT_EQ(camera.focus_distance, 4) << lines;
        EXPECT_EQ(warnings_of(with_camera(lines)), Lines()) << lines;
    }
}

TEST(ImportDialects, AnApertureIsADiameterOrAFactor) {
    const std::string wide = with_camera("APERTURE .5\nFOCALDISTANCE 4\n");
    EXPECT_EQ(scene_of(wide).camera.aperture_radius, 0.25);
    EXPECT_EQ(warnings_of(wide),
              Lines{"cis565.txt:12: warning: APERTURE .5 is read as the lens's diameter: programs differ"});
    EXPECT_EQ(scene_of(with_camera("LENSRAD 2\nAPERTURE .1\nFOCALDIST 4\n")).camera.aperture_radius, 0.2);
}

TEST(ImportDialects, WithoutADistanceTheLensIsSharpAtThePointLookedAt) {
    const std::string text = with_camera("LENSRADIUS .2\n");
    EXPECT_EQ(scene_of(text).camera.focus_distance, 3);
    EXPECT_EQ(
        warnings_of(text),
        Lines{"cis565.txt:12: warning: LENSRADIUS .2 without a distance of focus: sharp at the point looked at, 3 "
              "away"});
}

TEST(ImportDialects, SettingsMaySwitchTheLensOff) {
    const std::string lens = with_camera("LENSRADIUS .2\nFOCALDIST 4\n");
    EXPECT_EQ(scene_of("SETTINGS\nUSE_DOF 0\nSORT_MATERIALS 1\n\n" + lens).camera.aperture_radius, 0);
    EXPECT_EQ(scene_of("SETTINGS\nUSE_DOF 1\n\n" + lens).camera.aperture_radius, 0.2);
}

// yscaled = tan(FOVY pi / 180), pixelLength.y = 2 yscaled / height, and rays go to view - up pixelLength.y (y - height
// / 2): half a picture up is yscaled at a distance of 1.
TEST(ImportDialects, FovyIsHalfTheFieldOfView) {
    for (const double fovy : {10.0, 19.5, 45.0}) {
        const SceneCamera camera = scene_of(replaced(white, "FOVY 30", "FOVY " + std::to_string(fovy))).camera;
        const double height = 30, yscaled = std::tan(fovy * pi<double> / 180), pixel_length = 2 * yscaled / height;
        EXPECT_DOUBLE_EQ(std::tan(camera.vertical_fov_degrees / 2 * pi<double> / 180), pixel_length * height / 2);
    }
}

TEST(ImportDialects, ACameraThatIsTurnedIsNoted) {
    const ImportResult result = result_of(replaced(white, "LOOKAT 1 2 0", "LOOKAT 1 1 0"));
    EXPECT_EQ(
        result.notes.messages("cis565.txt", "note").back(),
        "cis565.txt:10: note: LOOKAT 1 1 0 is read as it stands; the course's viewer turns a camera that does not "
        "look along z in a way of its own");
}

TEST(ImportDialects, ReflAndRefrTogetherAreGlass) {
    const SceneMaterial glass = material_of("RGB 1 1 1\nSPECRGB 1 1 1\nREFL 1\nREFR 1\nREFRIOR 1.5\n");
    EXPECT_EQ(glass.type, MaterialType::dielectric);
    EXPECT_EQ(glass.ior, 1.5);
    EXPECT_EQ(warnings_of(with_material("RGB 1 1 1\nSPECRGB 1 1 1\nREFL 1\nREFR 1\nREFRIOR 1.5\n")), Lines());
    EXPECT_EQ(warnings_of(with_material("RGB 1 1 1\nSPECRGB 1 1 1\nREFL .4\nREFR 1\nREFRIOR 1.5\n")),
              Lines{"cis565.txt:4: warning: REFL .4 is read as 1: only whether it is above 0 counts"});
}

TEST(ImportDialects, RoughMetalAndRoughGlass) {
    const std::string metal = "RGB .5 .5 .5\nSPECRGB .5 .5 .5\nREFL 1\nROUGHNESS .5\n";
    EXPECT_EQ(material_of(metal).type, MaterialType::rough_conductor);
    EXPECT_EQ(material_of(metal).roughness, 0.5);
    EXPECT_EQ(
        warnings_of(with_material(metal)),
        Lines{"cis565.txt:5: warning: ROUGHNESS .5 is read as GGX of the width 0.25, its square: programs differ"});
    EXPECT_EQ(material_of("RGB 1 1 1\nREFR 1\nREFRIOR 1.3\nROUGHNESS .5\n").type, MaterialType::rough_dielectric);
}

TEST(ImportDialects, ATypeSaysWhatAMaterialIs) {
    EXPECT_EQ(material_of("TYPE MIRROR\nRGB .5 1 1\nSPECEX 0\nSPECRGB 0 0 0\n").type, MaterialType::mirror);
    EXPECT_EQ(material_of("TYPE GLASS\nRGB 1 1 1\nREFRIOR 1.5\n").type, MaterialType::dielectric);
    EXPECT_EQ(material_of("TYPE EMISSIVE\nRGB 1 1 1\nEMITTANCE 2\n").type, MaterialType::emitter);
    EXPECT_EQ(problems_of(with_material("TYPE VELVET\nRGB 1 1 1\n")),
              "cis565.txt:2: found \"TYPE VELVET\", allowed: Diffuse, Emitting, Specular, Mirror, Metal, Refractive, "
              "Glass, PBR, Microfacet, Disney, Plastic or Subsurface\n");
}

TEST(ImportDialects, MaterialInCapitalsIsTheObjectsOwn) {
    const std::string text = replaced(white, "material 0", "MATERIAL 0");
    EXPECT_EQ(result_of(text).json, result_of(white).json);
    EXPECT_EQ(problems_of(replaced(white, "material 0", "\nMATERIAL 0")).substr(0, 50),
              "cis565.txt:12: found OBJECT 0 without material, al");
}

TEST(ImportDialects, MotionToAPlaceAndInTheObjectsSpace) {
    const std::string to = replaced(white, "TRANS 0 0 0", "TRANS 1 2 3\nTRANS_DST 1 4 2");
    EXPECT_EQ(scene_of(to).objects[0].velocity, Vec3d(0, 2, -1));
    EXPECT_FALSE(scene_of(to).camera.shutter_late);
    const std::string inner = replaced(replaced(white, "SCALE 1 1 1", "SCALE 1 3 1\nANIMET 0 2 0\nANIMER 0 0 0"),
                                       "ROTAT 0 0 0", "ROTAT 0 0 90");
    EXPECT_EQ(scene_of(inner).objects[0].velocity, Vec3d(-6, 0, 0));
    const Scene moved = scene_of(white + "T_MOTION 1 2 3\nR_MOTION 0 0 0\n");
    EXPECT_EQ(moved.objects[0].velocity, Vec3d(1, 2, 3));
    EXPECT_FALSE(moved.camera.shutter_late);
    EXPECT_EQ(warnings_of(white + "R_MOTION 0 0 90\n").size(), 1u);
    EXPECT_EQ(warnings_of(white + "ANIMER 0 0 90\n"),
              Lines{"cis565.txt:18: warning: ANIMER 0 0 90 is lost: shapes neither turn nor grow; this one stays as it "
                    "is when the shutter opens"});
}

// ---- meshes ----

const std::string triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

struct MeshFolder {
    explicit MeshFolder(const std::string& mesh_lines)
        : text(replaced(replaced(white, "cube\n", mesh_lines), "RGB", "RGB")) {
        std::filesystem::create_directories(folder.path() / "scenes");
        std::filesystem::create_directories(folder.path() / "models");
        test::write_text(folder.file("models/one.obj"), triangle);
    }
    ImportResult import() const {
        return import_cis565(
            {.text = text, .file = folder.file("scenes/a.txt"), .out = folder.file("out.json"), .name = ""});
    }
    test::TemporaryFolder folder;
    std::string text;
};

TEST(ImportDialects, MeshesByTheirFilesInEverySpelling) {
    for (const std::string lines :
         {"mesh\nFILE ../models/one.obj\n", "mesh\n../models/one.obj\n", "obj\nFILENAME ..\\models\\one.obj\n",
          "OBJ ../models/one.obj\n", "custom_obj\nC:/Users/A Student/course/models/one.obj\n"}) {
        const MeshFolder given(lines);
        const ImportResult result = given.import();
        ASSERT_EQ(result.problems.messages("a", ""), Lines()) << lines;
        const Scene scene = parse_scene(result.json, given.folder.file("out.json"));
        ASSERT_EQ(scene.meshes.size(), 1u) << lines;
        EXPECT_NE(result.json.find("\"file\": \"models/one.obj\""), std::string::npos) << result.json;
    }
}

// Behind all objects, as some programs have it, or in the midst of one: the picture lacks its mesh.
TEST(ImportDialects, AMeshBesideAnotherShapeIsTold) {
    const std::string plain = test::with_material("RGB 1 1 1\n");
    const auto warnings = [](const std::string& text) {
        return import_cis565_scene(text, "a.txt").warnings.messages("a", "");
    };
    const std::string rest =
        " is lost: OBJECT 0 is a cube, and an object has one shape (write an OBJECT with a "
        "material for it)";
    EXPECT_EQ(warnings(plain), Lines());
    EXPECT_EQ(warnings(plain + "\nGLTF box.glb\n"), Lines{"a:19: GLTF box.glb" + rest});
    EXPECT_EQ(warnings(replaced(plain, "cube\n", "cube\nFILE a.obj\n")), Lines{"a:14: FILE a.obj" + rest});
    EXPECT_EQ(warnings(replaced(plain, "cube\n", "cube\nmesh\n")), Lines{"a:14: mesh" + rest});
}

TEST(ImportDialects, WhatAMeshFileHasBesidesIsTold) {
    const test::TemporaryFolder folder;
    test::write_text(folder.file("a.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nl 1 2\n");
    const std::string object = "OBJECT 1\nmesh\nFILE a.obj\nmaterial 0\nTRANS 5 0 0\nROTAT 0 0 0\nSCALE 1 1 1\n";
    const ImportResult result = import_cis565_scene(
        test::with_material("RGB 1 1 1\n") + "\n" + object + "\n" + replaced(object, "OBJECT 1", "OBJECT 2"),
        folder.file("a.txt"));
    EXPECT_EQ(result.warnings.messages("a", ""),
              std::vector<std::string>{"a:21: a.obj: line 5: p or l is passed over: points and lines have no area"});
}

TEST(ImportDialects, AMeshThatIsMissingOrBrokenIsAProblemOfItsLine) {
    const MeshFolder missing("mesh\nFILE two.obj\n");
    EXPECT_EQ(missing.import().problems.messages("a", ""),
              Lines{"a:14: found \"FILE two.obj\", allowed: a mesh file that is there, beside this one or in a folder "
                    "above it"});
    const MeshFolder broken("mesh\nFILE ../models/bad.obj\n");
    test::write_text(broken.folder.file("models/bad.obj"), "v 0 0\n");
    const Lines problems = broken.import().problems.messages("a", "");
    ASSERT_EQ(problems.size(), 1u);
    EXPECT_TRUE(problems[0].starts_with("a:14: found \"FILE ../models/bad.obj\", of which is said: ")) << problems[0];
}

TEST(ImportDialects, GlassOnAnOpenMeshIsAProblemOfItsMaterial) {
    MeshFolder given("mesh\nFILE ../models/one.obj\n");
    given.text = replaced(given.text, "RGB 1 1 1\n", "RGB 1 1 1\nREFR 1\nREFRIOR 1.5\n");
    const Lines problems = given.import().problems.messages("a", "");
    ASSERT_EQ(problems.size(), 1u);
    EXPECT_TRUE(problems[0].starts_with("a:17: found \"material 0\", which makes $.objects[0].material"))
        << problems[0];
    EXPECT_NE(problems[0].find("not closed"), std::string::npos) << problems[0];
}

}  // namespace
}  // namespace pt
