// What the importer says of a text: every problem at once, each reading that loses something, and what it leaves out.
#include "harness/interchange/import_findings.h"

#include <sstream>

#include <gtest/gtest.h>

#include "harness/counted.h"
#include "tests/support/cis565_texts.h"

namespace pt {
namespace {

using test::plain_camera, test::plain_object, test::problems_of, test::replaced, test::with_material;
using Lines = std::vector<std::string>;

Lines warnings_of(const std::string& text, const std::string& name = "") {
    const ImportResult result = import_cis565_scene(text, "cis565.txt", name);
    EXPECT_EQ(result.problems.messages("cis565.txt", ""), Lines());
    return result.warnings.messages("cis565.txt", "warning");
}

Lines notes_of(const std::string& text) {
    return import_cis565_scene(text, "cis565.txt").notes.messages("cis565.txt", "note");
}

// ---- problems ----

struct BadText {
    std::string from, to;  // what is replaced in the good text
    std::string problems;  // without "cis565.txt:", a line each
};

const std::string every_key = with_material(
    "RGB 1 1 1\nSPECEX 0\nSPECRGB 0 0 0\nREFL 0\nREFR 0\nREFRIOR 0\nEMITTANCE 0\n"
    "SIGMAA 0 0 0\nSIGMAS 0 0 0\n");

void expect_problems(const std::vector<BadText>& cases) {
    for (const BadText& bad : cases) {
        std::istringstream problems(bad.problems);
        std::string expected;
        for (std::string problem; std::getline(problems, problem);) {
            expected += "cis565.txt:" + problem + "\n";
        }
        EXPECT_EQ(problems_of(replaced(every_key, bad.from, bad.to)), expected) << bad.from << " -> " << bad.to;
    }
}

TEST(ImportFindings, AGoodTextHasNone) {
    EXPECT_EQ(problems_of(every_key), "");
    EXPECT_EQ(warnings_of(every_key), Lines());
}

TEST(ImportFindings, WhatIsNoLineOfTheFormat) {
    const std::string in_material =
        "in MATERIAL: RGB, SPECEX, SPECRGB, REFL, REFR, REFRIOR, EMITTANCE, SIGMAA, SIGMAS, ROUGHNESS, METALLIC, TYPE, "
        "TEXTURE";
    const std::string in_camera =
        "in CAMERA: RES, FOVY, ITERATIONS, DEPTH, FILE, EYE, LOOKAT, VIEW, UP, LENSRADIUS, FOCALDIST";
    expect_problems({
        {"MATERIAL 0", "PICTURE 0", R"(1: found "PICTURE 0", allowed: MATERIAL n, CAMERA or OBJECT n)"},
        {"MATERIAL 0", "MATERIAL 1", R"(22: found "material 0", allowed: material 0 to 0)"},
        {"MATERIAL 0", "MATERIAL", R"(1: found "MATERIAL", allowed: MATERIAL 0)"},
        {"OBJECT 0", "OBJECT 0 0", R"(20: found "OBJECT 0 0", allowed: OBJECT 0)"},
        {"OBJECT 0", "CAMERA", R"(20: found "CAMERA", allowed: one CAMERA; the first is in line 11)"},
        {"CAMERA", "CAMERA 0", R"(11: found "CAMERA 0", allowed: CAMERA alone on its line)"},
        {"SPECEX 0", "GLOSS 3", R"(3: found "GLOSS 3", allowed: )" + in_material},
        {"SPECEX 0", "SPECEXX 3", R"(3: found "SPECEXX 3", allowed: )" + in_material + " (did you mean \"SPECEX\"?)"},
        {"UP 0 1 0", "UP 0 1 0\nIRIS 1", R"(20: found "IRIS 1", allowed: )" + in_camera},
        {"cube", "mesh", "20: found OBJECT 0 without FILE, allowed: with the file of its mesh"},
        {"cube", "cone",
         "20: found OBJECT 0 without a shape, allowed: with cube or sphere\n"
         R"(21: found "cone", allowed: in OBJECT: cube, sphere, rect, mesh, material, TRANS, ROTAT, SCALE, VEL, FILE)"},
        {"cube", "cube 3", R"(21: found "cube 3", allowed: cube alone on its line)"},
        {"cube", "cube\nsphere", R"(22: found "sphere", allowed: sphere or cube once; line 21 has cube)"},
        {"RGB 1 1 1", "RGB 1 1 1\nRGB 1 1 1", R"(3: found "RGB 1 1 1", allowed: RGB once; line 2 has RGB)"},
        {"LOOKAT 1 2 0", "LOOKAT 1 2 0\nVIEW 0 0 1",
         R"(19: found "VIEW 0 0 1", allowed: VIEW or LOOKAT once; line 18 has LOOKAT)"},
    });
}

TEST(ImportFindings, WhatIsMissing) {
    expect_problems({
        {"cube\n", "", R"(20: found OBJECT 0 without a shape, allowed: with cube or sphere)"},
        {"RGB 1 1 1\n", "", R"(1: found MATERIAL 0 without RGB, allowed: with it)"},
        {"DEPTH 5\n", "", R"(11: found CAMERA without DEPTH, allowed: with it)"},
        {"FILE plain\n", "", R"(11: found CAMERA without FILE, allowed: with it; or import with --name NAME)"},
        {"LOOKAT 1 2 0\n", "", R"(11: found CAMERA without LOOKAT, allowed: with it)"},
        {"material 0\n", "", R"(20: found OBJECT 0 without material, allowed: with it)"},
        {"SCALE 1 1 1\n", "", R"(20: found OBJECT 0 without SCALE, allowed: with it)"},
        {plain_camera, "", R"( found no CAMERA, allowed: one)"},
    });
}

TEST(ImportFindings, WhatCannotBeRead) {
    expect_problems({
        {"RGB 1 1 1", "RGB 1 1", R"(2: found "RGB 1 1", allowed: RGB and 3 finite numbers)"},
        {"RGB 1 1 1", "RGB 1 1 1 1", R"(2: found "RGB 1 1 1 1", allowed: RGB and 3 finite numbers)"},
        {"RGB 1 1 1", "RGB 1 1 1x", R"(2: found "RGB 1 1 1x", allowed: RGB and 3 finite numbers)"},
        {"RGB 1 1 1", "RGB 1 nan 1", R"(2: found "RGB 1 nan 1", allowed: RGB and 3 finite numbers)"},
        {"RGB 1 1 1", "RGB 1 1 1e999", R"(2: found "RGB 1 1 1e999", allowed: RGB and 3 finite numbers)"},
        {"RGB 1 1 1", "RGB x y z", R"(2: found "RGB x y z", allowed: RGB and 3 finite numbers)"},
        {"SPECEX 0", "SPECEX -1", R"(3: found "SPECEX -1", allowed: SPECEX of 0 or more)"},
        {"EMITTANCE 0", "EMITTANCE inf", R"(8: found "EMITTANCE inf", allowed: EMITTANCE and 1 finite number)"},
        {"EMITTANCE 0", "EMITTANCE", R"(8: found "EMITTANCE", allowed: EMITTANCE and 1 finite number)"},
        {"RES 40 30", "RES 40", R"(12: found "RES 40", allowed: RES and 2 whole numbers, width and height)"},
        {"RES 40 30", "RES 40 30.5", R"(12: found "RES 40 30.5", allowed: RES and 2 whole numbers, width and height)"},
        {"DEPTH 5", "DEPTH 5.5", R"(15: found "DEPTH 5.5", allowed: DEPTH and 1 whole number)"},
        {"DEPTH 5", "DEPTH 5 5", R"(15: found "DEPTH 5 5", allowed: DEPTH and 1 whole number)"},
        {"ITERATIONS 10", "ITERATIONS many", R"(14: found "ITERATIONS many", allowed: ITERATIONS and 1 finite number)"},
        {"FILE plain", "FILE my scene",
         R"(16: found "FILE my scene", allowed: FILE and a name: 1 to 64 letters, digits, '_' and '-'; or import with )"
         "--name NAME"},
        {"FILE plain", "FILE a+b",
         R"(16: found "FILE a+b", allowed: FILE and a name: 1 to 64 letters, digits, '_' and '-'; or import with )"
         "--name NAME"},
        {"material 0", "material 1", R"(22: found "material 1", allowed: material 0 to 0)"},
        {"material 0", "material", R"(22: found "material", allowed: material 0 to 0)"},
    });
}

TEST(ImportFindings, WhatNoMaterialIs) {
    expect_problems({
        {"REFL 0\nREFR 0\nREFRIOR 0\nEMITTANCE 0\nSIGMAA 0 0 0\nSIGMAS 0 0 0",
         "REFL 1\nREFR 0\nREFRIOR 0\nEMITTANCE 0\nSIGMAA 0 0 0\nSIGMAS 1 1 1",
         "10: found SIGMAS together with REFL, allowed: SIGMAS where REFL and SPECEX are 0 (a subsurface body reflects "
         "by its index alone)"},
    });
}

// Read, but beyond what scene files allow: the line that the value comes from is named, not a place in a file that
// nobody has.
TEST(ImportFindings, WhatNoSceneFileHolds) {
    const std::string fraction = ", allowed: a number from 0 to 1";
    expect_problems({
        {"RGB 1 1 1", "RGB 1 1.5 1",
         R"(2: found "RGB 1 1.5 1", which makes $.materials.material_0.albedo[1] 1.5)" + fraction},
        {"SPECRGB 0 0 0\nREFL 0", "SPECRGB 2 1 1\nREFL 1",
         R"(4: found "SPECRGB 2 1 1", which makes $.materials.material_0.reflectance[0] 2)" + fraction},
        {"REFR 0", "REFR 1",
         R"(7: found "REFRIOR 0", which makes $.materials.material_0.ior 0, allowed: a number from 0.01 to 1e4)"},
        {"REFR 0\nREFRIOR 0", "REFR 1",
         R"(6: found "REFR 1", which makes $.materials.material_0.ior 0, allowed: a number from 0.01 to 1e4)"},
        {"EMITTANCE 0", "EMITTANCE 1e31",
         R"(8: found "EMITTANCE 1e31", which makes $.materials.material_0.radiance[0] 1e+31, allowed: a number from )"
         "0 to 1e30"},
        {"SIGMAS 0 0 0", "SIGMAS -1 0 0",
         R"(10: found "SIGMAS -1 0 0", which makes $.materials.material_0.sigma_s[0] -1, allowed: a number from )"
         "0 to 1e18"},
        {"FOVY 30", "FOVY 90",
         R"(13: found "FOVY 90", which makes $.camera.vertical_fov_degrees 180, allowed: an angle from 1e-6 to 179.999 )"
         "degrees"},
        {"RES 40 30", "RES 40 0",
         R"(12: found "RES 40 0", which makes $.camera.resolution[1] 0, allowed: a whole number from 1 to 65536)"},
        {"UP 0 1 0", "UP 0 0 1",
         R"(19: found "UP 0 0 1", which makes $.camera.up [0,0,1], allowed: a direction that is not 0 and not )"
         "parallel to look_at - eye"},
        {"LOOKAT 1 2 0", "LOOKAT 1 2 3",
         R"(18: found "LOOKAT 1 2 3", which makes $.camera.look_at [1,2,3], allowed: a point other than camera.eye, )"
         "at least 1e-18 away"},
        {"DEPTH 5", "DEPTH 0",
         R"(15: found "DEPTH 0", which makes $.max_depth 0, allowed: a whole number from 1 to 1000000)"},
        {"SCALE 1 1 1", "SCALE 1 0 1",
         R"(25: found "SCALE 1 0 1", which makes $.objects[0].scale[1] 0, allowed: a number from 1e-18 to 1e18)"},
    });
}

// Beyond double, but only by what the importer makes of it.
TEST(ImportFindings, WhatOverflowsIsTooLarge) {
    const std::string largest = "1.7976931348623157e+308";
    expect_problems({
        {"FOVY 30", "FOVY 1e308",
         R"(13: found "FOVY 1e308", which makes $.camera.vertical_fov_degrees )" + largest +
             ", allowed: an angle from 1e-6 to 179.999 degrees"},
        {"EYE 1 2 3\nLOOKAT 1 2 0", "EYE 1 2 0\nVIEW 1e308 0 1e308",
         R"(18: found "VIEW 1e308 0 1e308", which makes $.camera.look_at[0] 1e+308, allowed: a number from -1e18 to 1e18)"},
        {"RGB 1 1 1\nSPECEX 0\nSPECRGB 0 0 0\nREFL 0\nREFR 0\nREFRIOR 0\nEMITTANCE 0", "RGB 1e308 1 1\nEMITTANCE 10",
         R"(3: found "EMITTANCE 10", which makes $.materials.material_0.radiance[0] )" + largest +
             ", allowed: a number from 0 to 1e30"},
    });
}

TEST(ImportFindings, AllProblemsAreListedInTheOrderOfTheFile) {
    std::string text = every_key;
    text = replaced(text, "RGB 1 1 1", "RGB 1 1.5 1");
    text = replaced(text, "SIGMAS 0 0 0\n", "SIGMAS 0 0 0\nMATERIAL 1\nRGB 1 1\nGLOSS 1\nSPECEX x\n");
    text = replaced(text, "FOVY 30", "FOVY 90");
    text = replaced(text, "LOOKAT 1 2 0", "LOOKAT 1 2 3");
    text = replaced(text, "DEPTH 5", "DEPTH 0");
    text = replaced(text, "FILE plain", "FILE my scene");
    text += "VEL 1 1\nOBJECT 1\nsphere\nmaterial 5\nTRANS 0 0 1e19\nROTAT 1e7 0 0\nSCALE 0 1 1\n";
    EXPECT_EQ(
        problems_of(text),
        R"(cis565.txt:2: found "RGB 1 1.5 1", which makes $.materials.material_0.albedo[1] 1.5, allowed: a number from 0 to 1
cis565.txt:12: found "RGB 1 1", allowed: RGB and 3 finite numbers
cis565.txt:13: found "GLOSS 1", allowed: in MATERIAL: RGB, SPECEX, SPECRGB, REFL, REFR, REFRIOR, EMITTANCE, SIGMAA, SIGMAS, ROUGHNESS, METALLIC, TYPE, TEXTURE
cis565.txt:14: found "SPECEX x", allowed: SPECEX and 1 finite number
cis565.txt:17: found "FOVY 90", which makes $.camera.vertical_fov_degrees 180, allowed: an angle from 1e-6 to 179.999 degrees
cis565.txt:19: found "DEPTH 0", which makes $.max_depth 0, allowed: a whole number from 1 to 1000000
cis565.txt:20: found "FILE my scene", allowed: FILE and a name: 1 to 64 letters, digits, '_' and '-'; or import with --name NAME
cis565.txt:22: found "LOOKAT 1 2 3", which makes $.camera.look_at [1,2,3], allowed: a point other than camera.eye, at least 1e-18 away
cis565.txt:30: found "VEL 1 1", allowed: VEL and 3 finite numbers
cis565.txt:33: found "material 5", allowed: material 0 to 1
cis565.txt:34: found "TRANS 0 0 1e19", which makes $.objects[1].translate[2] 1e+19, allowed: a number from -1e18 to 1e18
cis565.txt:35: found "ROTAT 1e7 0 0", which makes $.objects[1].rotate_degrees[0] 10000000, allowed: an angle from -1e6 to 1e6 degrees
cis565.txt:36: found "SCALE 0 1 1", which makes $.objects[1].scale[0] 0, allowed: a number from 1e-18 to 1e18
)");
}

// What an unreadable line of a material would have made of the others, nobody knows: as a lamp's, 1.5 is good.
TEST(ImportFindings, AMaterialThatIsNotWholeIsNotJudged) {
    expect_problems(
        {{"RGB 1 1 1\nSPECEX 0\nSPECRGB 0 0 0\nREFL 0\nREFR 0\nREFRIOR 0\nEMITTANCE 0",
          "RGB 1 1.5 1\nEMITANCE 5\nSPECRGB 1 1 1",
          "3: found \"EMITANCE 5\", allowed: in MATERIAL: RGB, SPECEX, SPECRGB, REFL, REFR, REFRIOR, EMITTANCE, "
          "SIGMAA, SIGMAS, ROUGHNESS, METALLIC, TYPE, TEXTURE (did you mean \"EMITTANCE\"?)"}});
}

// The first of a number counts, as in the course's programs.
TEST(ImportFindings, ANumberThatIsThereTwice) {
    const std::string text = with_material("RGB 1 1 1\nMATERIAL 0\nRGB .5 1 1\n");
    EXPECT_EQ(warnings_of(text),
              (Lines{"cis565.txt:3: warning: MATERIAL 0 stands where MATERIAL 1 does: it is not left out",
                     "cis565.txt:3: warning: MATERIAL 0 is not used: line 1 has it"}));
    const Scene scene = parse_scene(import_cis565_scene(text, "cis565.txt").json, "scene.json");
    EXPECT_EQ(scene.materials.at(scene.objects.at(0).material).albedo, Vec3d(1.0));
}

// A head that is not known makes the lines behind it no problems of their own.
TEST(ImportFindings, AProblemIsToldOnce) {
    EXPECT_EQ(problems_of(replaced(every_key, "MATERIAL 0", "PICTURE 0\nTITLE sky")),
              "cis565.txt:1: found \"PICTURE 0\", allowed: MATERIAL n, CAMERA or OBJECT n\n"
              "cis565.txt:2: found \"TITLE sky\", allowed: MATERIAL n, CAMERA or OBJECT n\n");
}

TEST(ImportFindings, NumbersThatDoNotCountUpAreWordsToCallMaterialsBy) {
    const std::string text = replaced(with_material("RGB 1 1 1\nMATERIAL 9\nRGB .5 1 1\nMATERIAL blue\nRGB 0 0 1\n"),
                                      "material 0", "material 9");
    EXPECT_EQ(warnings_of(replaced(text, "OBJECT 0", "OBJECT 7")),
              (Lines{"cis565.txt:3: warning: MATERIAL 9 stands where MATERIAL 1 does: it is not left out",
                     "cis565.txt:5: warning: MATERIAL blue stands where MATERIAL 2 does: it is not left out",
                     "cis565.txt:16: warning: OBJECT 7 stands where OBJECT 0 does: it is not left out"}));
    const Scene scene = parse_scene(import_cis565_scene(text, "cis565.txt").json, "scene.json");
    EXPECT_EQ(scene.materials.at(scene.objects.at(0).material).albedo, Vec3d(.5, 1, 1));
}

TEST(ImportFindings, ABodyAboutTheEyeIsAProblemOfTheEye) {
    const std::string text = replaced(with_material("RGB 1 1 1\nSIGMAS 1 1 1\n"), "SCALE 1 1 1", "SCALE 10 10 10");
    EXPECT_EQ(
        problems_of(replaced(text, "OBJECT 0",
                             "OBJECT 0\nsphere\nmaterial 0\nTRANS 50 0 0\nROTAT 0 0 0\nSCALE 1 "
                             "1 1\nOBJECT 1")),
        "cis565.txt:10: found \"EYE 1 2 3\", which makes $.camera.eye a point inside $.objects[1], a subsurface body, "
        "allowed: a point outside of subsurface bodies\n");
}

TEST(ImportFindings, FiftyProblemsAreListedAndTheOthersCounted) {
    std::string text = replaced(every_key, "RGB 1 1 1", "RGB 2 1 1");  // found last, listed first
    for (int i = 0; i < 60; ++i) {
        text += "FOO " + std::to_string(i + 1) + "\n";
    }
    const ImportResult result = import_cis565_scene(text, "cis565.txt");
    EXPECT_EQ(result.problems.count(), 61u);
    const Lines lines = result.problems.messages("cis565.txt", "");
    ASSERT_EQ(lines.size(), 51u);
    EXPECT_TRUE(lines.front().starts_with("cis565.txt:2: found \"RGB 2 1 1\"")) << lines.front();
    EXPECT_TRUE(lines[49].starts_with("cis565.txt:74: found \"FOO 49\"")) << lines[49];
    EXPECT_EQ(lines.back(), "cis565.txt: and 11 more");
}

TEST(ImportFindings, AHugeTextIsRefusedAndOneThatIsAllWrongIsNotSlow) {
    EXPECT_EQ(problems_of(std::string(largest_import + 1, '\n')),
              "cis565.txt: found 16777217 bytes, allowed: at most 16777216\n");
    std::string text;
    for (int i = 0; i < 200000; ++i) {
        text += "FOO\n";
    }
    EXPECT_EQ(import_cis565_scene(text, "cis565.txt").problems.count(), 200001u);
}

TEST(ImportFindings, WhatTheyQuoteIsShortAndSafe) {
    std::string long_line = "FOO ";
    for (int i = 0; i < 60; ++i) {
        long_line += "\u00e9";
    }
    const std::string message = problems_of(every_key + long_line + "\n");
    ASSERT_TRUE(message.starts_with("cis565.txt:26: found \"FOO \u00e9\u00e9")) << message;
    EXPECT_NE(message.find("\u00e9...\", allowed: "), std::string::npos) << message;  // cut between two characters
    EXPECT_LT(message.find("...\", allowed: "), 105u) << message;
    const std::string unsafe = problems_of(every_key + "FOO \x1b[31m \xff\n");
    EXPECT_TRUE(unsafe.starts_with("cis565.txt:26: found \"FOO \\x1b[31m \\xff\"")) << unsafe;
}

// ---- warnings ----

struct Reading {
    std::string material;  // its lines
    Lines warnings;        // without "cis565.txt:" and "warning: "
};

void expect_warnings(const std::vector<Reading>& cases) {
    for (const Reading& reading : cases) {
        Lines expected;
        for (const std::string& warning : reading.warnings) {
            const std::size_t colon = warning.find(':');
            expected.push_back("cis565.txt:" + warning.substr(0, colon) + ": warning" + warning.substr(colon));
        }
        EXPECT_EQ(warnings_of(with_material(reading.material)), expected) << reading.material;
    }
}

TEST(ImportFindings, ExactReadingsAreSilent) {
    expect_warnings({
        {"RGB .1 .2 .3\n", {}},
        {"RGB 1 .5 .25\nEMITTANCE 4\n", {}},
        {"RGB .9 .9 .9\nSPECRGB .9 .9 .9\nREFL 1\n", {}},
        {"RGB .9 .9 .9\nSPECRGB .9 .9 .9\nREFR 1\nREFRIOR 1.5\nSIGMAA 0 1 2\n", {}},
        {"RGB 0 0 0\nREFL 1\n", {}},
        {"RGB 1 1 1\nSIGMAA 1 2 3\nSIGMAS 1 2 3\n", {}},
        {"RGB 1 1 1\nSPECRGB 1 1 1\nREFR 1\nREFRIOR 1.3\nSIGMAS 1 2 3\n", {}},
    });
    std::string text = replaced(every_key, "LOOKAT 1 2 0", "VIEW 0 0 -1");
    text = replaced(text, "ROTAT 0 0 0", "ROTAT 10 20 30") + "VEL 0 0 0\n";
    EXPECT_EQ(warnings_of(text), Lines());
}

TEST(ImportFindings, TheExponentsSizeIsLost) {
    for (const std::string exponent : {"25", "100", "0.5"}) {
        expect_warnings({{"RGB .1 .2 .3\nSPECEX " + exponent + "\nSPECRGB .7 .8 .9\n",
                          {"3: SPECEX " + exponent +
                           " is read as a mix, a mirror with probability 0.5 and else diffuse; the exponent's size is "
                           "lost"}}});
    }
}

TEST(ImportFindings, AnEmitterUsesNothingElse) {
    const std::string reason = " is not used: material 0 is an emitter (EMITTANCE 5)";
    expect_warnings(
        {{"RGB 1 1 1\nSPECEX 2\nSPECRGB 1 0 0\nREFL 1\nREFR 1\nREFRIOR 1.5\nEMITTANCE 5\nSIGMAA 1 0 0\n"
          "SIGMAS 0 1 0\n",
          {"3: SPECEX 2" + reason, "4: SPECRGB 1 0 0" + reason, "5: REFL 1" + reason, "6: REFR 1" + reason,
           "7: REFRIOR 1.5" + reason, "9: SIGMAA 1 0 0" + reason, "10: SIGMAS 0 1 0" + reason}}});
}

TEST(ImportFindings, ADiffuseMaterialUsesRgbAlone) {
    const std::string reason = " is not used: material 0 is diffuse";
    expect_warnings({{"RGB 1 1 1\nSPECRGB 1 1 1\nREFRIOR 1.5\nSIGMAA 1 0 0\n",
                      {"3: SPECRGB 1 1 1" + reason, "4: REFRIOR 1.5" + reason, "5: SIGMAA 1 0 0" + reason}}});
}

TEST(ImportFindings, AMirrorHasOneColour) {
    const std::string reason = " is not used: material 0 is a mirror";
    expect_warnings({
        {"RGB .1 .2 .3\nSPECRGB .7 .8 .9\nREFL 1\n", {"2: RGB .1 .2 .3" + reason + " of colour SPECRGB .7 .8 .9"}},
        {"RGB .1 .2 .3\nSPECRGB 0 0 0\nREFL 1\n", {"3: SPECRGB 0 0 0" + reason + " of colour RGB .1 .2 .3"}},
        {"RGB .1 .2 .3\nREFL 1\n", {"3: REFL 1 has no SPECRGB: material 0 is a mirror of colour RGB .1 .2 .3"}},
        {"RGB 1 1 1\nSPECRGB 1 1 1\nREFL 0.5\n", {"4: REFL 0.5 is read as 1: only whether it is above 0 counts"}},
        {"RGB 1 1 1\nSPECRGB 1 1 1\nREFL 1\nSPECEX 9\nREFRIOR 2\nSIGMAA 1 1 1\n",
         {"5: SPECEX 9" + reason, "6: REFRIOR 2" + reason, "7: SIGMAA 1 1 1" + reason}},
    });
}

TEST(ImportFindings, ADielectricHasOneColour) {
    const std::string reason = " is not used: material 0 is a dielectric";
    expect_warnings({
        {"RGB .1 .2 .3\nSPECRGB 1 1 1\nREFR 1\nREFRIOR 1.5\n",
         {"2: RGB .1 .2 .3" + reason + " of colour SPECRGB 1 1 1"}},
        {"RGB .1 .2 .3\nSPECRGB 0 0 0\nREFR 1\nREFRIOR 1.5\n",
         {"3: SPECRGB 0 0 0" + reason + " of colour RGB .1 .2 .3"}},
        {"RGB 1 1 1\nREFR 2\nREFRIOR 1.5\nSPECEX 4\n",
         {"3: REFR 2 is read as 1: only whether it is above 0 counts",
          "3: REFR 2 has no SPECRGB: material 0 is a dielectric of colour RGB 1 1 1", "5: SPECEX 4" + reason}},
    });
}

TEST(ImportFindings, AMixUsesNoMedium) {
    const std::string reason = " is not used: material 0 is a mix of diffuse and a mirror";
    expect_warnings(
        {{"RGB 1 1 1\nSPECEX 4\nREFRIOR 1.5\nSIGMAA 1 0 0\n",
          {"3: SPECEX 4 is read as a mix, a mirror with probability 0.5 and else diffuse; the exponent's size "
           "is lost",
           "3: SPECEX 4 has no SPECRGB: material 0 is a mix of diffuse and a mirror of colour RGB 1 1 1",
           "4: REFRIOR 1.5" + reason, "5: SIGMAA 1 0 0" + reason}}});
}

TEST(ImportFindings, ABodyHasNoColourAndItsIndexIsRefrior) {
    const std::string reason = " is not used: material 0 is a subsurface body, of SIGMAA and SIGMAS alone";
    expect_warnings({
        {"RGB .5 1 1\nSPECRGB .5 .5 .5\nSIGMAS 1 2 3\n", {"2: RGB .5 1 1" + reason, "3: SPECRGB .5 .5 .5" + reason}},
        {"RGB 1 1 1\nREFRIOR 1.3\nSIGMAS 1 2 3\n",
         {"3: REFRIOR 1.3 is used although REFR is 0: material 0 is a subsurface body"}},
        {"RGB 1 1 1\nREFR .5\nSIGMAS 1 2 3\n",
         {"3: REFR .5 is read as 1: only whether it is above 0 counts",
          "3: REFR .5 without a REFRIOR above 0 is read as the index 1: material 0 is a subsurface body"}},
    });
}

TEST(ImportFindings, TheShutterIsChosenOnce) {
    std::string second = replaced(plain_object, "OBJECT 0", "OBJECT 1");
    const std::string text = with_material("RGB 1 1 1\n") + "VEL 0 0 0\n" + second + "VEL 0 -2 0\n" +
                             replaced(plain_object, "OBJECT 0", "OBJECT 2") + "VEL 1 0 0\n";
    EXPECT_EQ(
        warnings_of(text),
        Lines{"cis565.txt:25: warning: VEL 0 -2 0: the file does not say when the shutter is open; it is open from 0 "
              "to 1 with the density \"late\""});
}

// ---- names ----

TEST(ImportFindings, ANameOfTheCallsOwnGoesBeforeFile) {
    const auto name_in = [](const std::string& text) {
        const ImportResult result = import_cis565_scene(text, "cis565.txt", "mine");
        return result.problems.count() == 0 ? parse_scene(result.json, "cis565.json").name : "";
    };
    EXPECT_EQ(name_in(every_key), "mine");
    EXPECT_EQ(warnings_of(every_key, "mine"), Lines());
    const std::string without = replaced(every_key, "FILE plain\n", "");
    EXPECT_EQ(name_in(without), "mine");
    EXPECT_EQ(warnings_of(without, "mine"), Lines());
    for (const std::string bad : {"FILE my scene", "FILE a+b", "FILE"}) {
        const std::string text = replaced(every_key, "FILE plain", bad);
        EXPECT_EQ(name_in(text), "mine");
        EXPECT_EQ(warnings_of(text, "mine"),
                  Lines{"cis565.txt:16: warning: " + bad + " is not used: it is no scene name, mine is"});
    }
}

// ---- notes ----

TEST(ImportFindings, WhatIsLeftOutAndWhatIsKeptUnusedIsNoted) {
    const std::string samples = "ITERATIONS 10 is left out: how many samples a pixel gets is a run's business (--spp)";
    EXPECT_EQ(notes_of(every_key), Lines{"cis565.txt:14: note: " + samples});
    EXPECT_EQ(notes_of(replaced(every_key, "ITERATIONS 10\n", "")), Lines());
    EXPECT_EQ(notes_of(with_material("RGB 1 1 1\nMATERIAL 1\nRGB 1 1 1\n")),
              (Lines{"cis565.txt: note: kept, though no object has it: material 1", "cis565.txt:8: note: " + samples}));
    std::string many = "RGB 1 1 1\n";
    for (int i = 1; i <= 12; ++i) {
        many += "MATERIAL " + std::to_string(i) + "\nRGB 1 1 1\n";
    }
    EXPECT_EQ(notes_of(with_material(many)).front(),
              "cis565.txt: note: kept, though no object has it: material 1, 2, 3, 4, 5, 6, 7, 8, 9, 10 and 2 more");
}

TEST(ImportFindings, CountsAreWords) {
    EXPECT_EQ(counted(0, "warning"), "0 warnings");
    EXPECT_EQ(counted(1, "warning"), "1 warning");
    EXPECT_EQ(counted(12, "object"), "12 objects");
}

}  // namespace
}  // namespace pt
