// export as a user calls it: the XML of a scene with one of everything, every refusal at once, and what is written.
#include <gtest/gtest.h>

#include "harness/interchange/export_mitsuba.h"
#include "harness/interchange/mitsuba_limits.h"
#include "harness/interchange/xml_text.h"
#include "harness/mesh/read_mesh.h"
#include "tests/support/command.h"
#include "tests/support/places.h"
#include "tests/support/scenes.h"

namespace pt::test {
namespace {

using Arguments = std::vector<std::string>;

const std::string camera =
    R"("camera": {"eye": [0, 1, 8], "look_at": [0, 1, 0], "up": [0, 1, 0], "vertical_fov_degrees": 40, "resolution": [32, 16])";

std::string scene_text(const std::string& more_of_camera, const std::string& materials, const std::string& objects) {
    return R"({"name": "small", "max_depth": 5, "environment": [0.25, 0, 0], )" + camera + more_of_camera +
           R"(}, "materials": {)" + materials + R"(}, "objects": [)" + objects + "]}";
}

// Runs `export small.json --format mitsuba --out OUT` in a folder with that scene.
struct Exported {
    explicit Exported(const std::string& scene, const std::string& out = "small.xml", const Arguments& added = {}) {
        write_text(folder.file("small.json"), scene);
        Arguments arguments{"export", "small.json", "--format", "mitsuba", "--out", out};
        arguments.insert(arguments.end(), added.begin(), added.end());
        command = ptbench(arguments, {.folder = folder.path()});
    }

    TemporaryFolder folder;
    CommandResult command;
};

const std::string white = R"("white <&\">": {"type": "diffuse", "albedo": [0.5, 0.25, 0.125]})";
const std::string one_quad = R"({"shape": "quad", "material": "white <&\">", "scale": 2, "translate": [0, -1, 3]})";

TEST(ExportCommandTest, TheWholeFileOfASmallScene) {
    const Exported exported(scene_text("", white, one_quad));
    EXPECT_EQ(exported.command.exit_code, 0) << exported.command.err;
    EXPECT_EQ(exported.command.out, "small: 1 object, 0 mesh files -> small.xml\n");
    EXPECT_EQ(exported.command.err, "");
    EXPECT_EQ(exported.folder.content(), (Arguments{"small.json", "small.xml"}));
    EXPECT_EQ(content_of(exported.folder.file("small.xml")), R"(<?xml version="1.0" encoding="utf-8"?>
<scene version="3.0.0">
  <integrator type="path">
    <integer name="max_depth" value="5"/>
    <integer name="rr_depth" value="6"/>
  </integrator>
  <sensor type="perspective">
    <float name="fov" value="40"/>
    <string name="fov_axis" value="y"/>
    <float name="near_clip" value="9.1552734375e-05"/>
    <float name="far_clip" value="48"/>
    <transform name="to_world">
      <lookat origin="0, 1, 8" target="0, 1, 0" up="0, 1, 0"/>
    </transform>
    <film type="hdrfilm">
      <integer name="width" value="32"/>
      <integer name="height" value="16"/>
      <string name="pixel_format" value="rgb"/>
      <string name="component_format" value="float32"/>
      <rfilter type="box"/>
    </film>
    <sampler type="independent">
      <integer name="sample_count" value="64"/>
    </sampler>
  </sensor>
  <emitter type="constant">
    <rgb name="radiance" value="0.25, 0, 0"/>
  </emitter>
  <bsdf type="twosided" id="material_0">
    <bsdf type="diffuse">
      <rgb name="reflectance" value="0.5, 0.25, 0.125"/>
    </bsdf>
  </bsdf>
  <shape type="rectangle">
    <transform name="to_world">
      <matrix value="1 0 0 0 0 0 1 -1 0 -1 0 3 0 0 0 1"/>
    </transform>
    <ref name="bsdf" id="material_0"/>
  </shape>
</scene>
)");
}

// The lines of the XML from the first that has `start`, as many as asked for, without their indent.
std::string lines_from(const std::string& xml, const std::string& start, int count) {
    std::istringstream stream(xml.substr(xml.find(start)));
    std::string text, line;
    for (int i = 0; i < count && std::getline(stream, line); ++i) {
        text += line.substr(line.find_first_not_of(' ')) + "\n";
    }
    return text;
}

TEST(ExportCommandTest, ALensAScaleAndWhatTheCallAsksFor) {
    const Exported exported(scene_text(R"(, "aperture_radius": 0.5, "focus_distance": 3)", white, one_quad), "a/b.xml",
                            {"--scale", "4", "--resolution", "7x9", "--depth", "2", "--spp", "3"});
    EXPECT_EQ(exported.command.exit_code, 0) << exported.command.err;
    const std::string xml = content_of(exported.folder.file("a/b.xml"));
    EXPECT_EQ(
        lines_from(xml, "<sensor", 5),
        "<sensor type=\"thinlens\">\n<float name=\"fov\" value=\"40\"/>\n<string name=\"fov_axis\" value=\"y\"/>\n"
        "<float name=\"aperture_radius\" value=\"2\"/>\n<float name=\"focus_distance\" value=\"12\"/>\n");
    EXPECT_NE(xml.find("<lookat origin=\"0, 4, 32\" target=\"0, 4, 0\" up=\"0, 1, 0\"/>"), std::string::npos);
    EXPECT_NE(xml.find("<matrix value=\"4 0 0 0 0 0 4 -4 0 -4 0 12 0 0 0 1\"/>"), std::string::npos) << xml;
    for (const char* wanted : {R"("max_depth" value="2")", R"("rr_depth" value="3")", R"("width" value="7")",
                               R"("height" value="9")", R"("sample_count" value="3")"}) {
        EXPECT_NE(xml.find(wanted), std::string::npos) << wanted;
    }
}

TEST(ExportCommandTest, AFolderGetsTheSceneByItsName) {
    const Exported exported(scene_text("", white, one_quad), "here");
    EXPECT_EQ(exported.command.exit_code, 0) << exported.command.err;
    EXPECT_EQ(exported.folder.content(), (Arguments{"here", "here/small.xml", "small.json"}));
}

TEST(ExportCommandTest, ARoughnessMapIsRefused) {
    const std::string tiles = test::in_source("scenes/textures/tiles.png");
    const Exported exported(scene_text(
        "",
        R"("steel": {"type": "rough_conductor", "reflectance": [1, 1, 1], "roughness": {"image": ")" + tiles + "\"}}",
        R"({"shape": "quad", "material": "steel"})"));
    EXPECT_EQ(exported.command.exit_code, 2);
    EXPECT_NE(exported.command.err.find("$.materials.steel.roughness: found the image " + tiles +
                                        ", allowed: one number: roughness maps are not exported\n"),
              std::string::npos)
        << exported.command.err;
}

TEST(ExportCommandTest, EveryReasonIsListedAndNothingIsWritten) {
    const std::string materials =
        R"("gold": {"type": "mix", "albedo": [1, 1, 1], "reflectance": [1, 1, 1], "mirror_probability": 0.5},
           "wax": {"type": "subsurface", "sigma_s": [1, 1, 1], "max_scatterings": 9}, "lamp": {"type": "emitter", "radiance": [1, 1, 1]},
           "unused": {"type": "subsurface", "sigma_s": [1, 1, 1]},
           "steel": {"type": "rough_conductor", "reflectance": [1, 1, 1], "roughness": 0.5},
           "glass": {"type": "dielectric", "ior": 1.5}, "ink": {"type": "dielectric", "ior": 1, "sigma_a": [1, 0, 0]})";
    const std::string objects =
        R"({"shape": "sphere", "material": "gold", "scale": [1, 2, 1]},
           {"shape": "box", "material": "wax", "velocity": [1, 0, 0]},
           {"shape": "box", "material": "glass", "translate": [0, 1, 8]},
           {"shape": "box", "material": "lamp", "translate": [0.5, 1, 8]},
           {"shape": "sphere", "material": "ink", "translate": [0, 1.5, 8], "scale": 0.5},
           {"shape": "quad", "material": "steel"},
           {"shape": "mesh", "material": "lamp", "vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "triangles": [[0, 1, 2]]})";
    const Exported exported(scene_text(R"(, "jitter": false, "shutter": {"open": 0, "close": 1})", materials, objects));
    EXPECT_EQ(exported.command.exit_code, 2);
    EXPECT_EQ(exported.command.out, "");
    EXPECT_EQ(exported.folder.content(), Arguments{"small.json"});
    const Arguments begins{
        "$.camera.jitter: found false, allowed: true",
        "$.materials.gold.mirror_probability: found 0.5, allowed: 0 or 1",
        "$.materials.steel: found rough facets, allowed: another material",
        "$.materials.wax: found subsurface at depth 5, allowed: --depth 1000 or more",
        "$.materials.wax.max_scatterings: found 9, allowed: none",
        "$.objects[0].scale: found [1, 2, 1], allowed: one number for a sphere",
        "$.objects[1].velocity: found [1, 0, 0], allowed: 0 while the shutter is open",
        "$.objects[1]: found a subsurface body whose box meets that of $.objects[0], allowed: bodies apart",
        "$.objects[1]: found a subsurface body whose box meets that of $.objects[5], allowed: bodies apart",
        "$.objects[1]: found a subsurface body whose box meets that of $.objects[6], allowed: bodies apart",
        "$.objects[2]: found a dielectric with the eye inside, allowed: an eye outside",
        "$.objects[2]: found a dielectric whose box meets that of $.objects[3], a lamp, allowed: lamps outside",
        "$.objects[2]: found a dielectric whose box meets that of $.objects[4], a dielectric, and one of them absorbs",
        "$.objects[4]: found a dielectric whose box meets that of $.objects[2], a dielectric, and one of them absorbs",
        "$.objects[6]: found the mesh of the scene file, which emits and is not closed, allowed: a closed mesh",
    };
    std::istringstream lines(exported.command.err);
    std::string line;
    for (const std::string& begin : begins) {
        std::getline(lines, line);
        EXPECT_EQ(line.substr(0, 21 + begin.size()), "ptbench: small.json: " + begin);
    }
    std::getline(lines, line);
    EXPECT_EQ(line, "ptbench: small.json: 15 problems; nothing is written");
    EXPECT_FALSE(std::getline(lines, line));
}

TEST(ExportCommandTest, MeshesAreFilesAndCopiesAreInstances) {
    const std::string materials =
        R"("white": {"type": "diffuse", "albedo": [1, 1, 1]}, "lamp": {"type": "emitter", "radiance": [1, 2, 3]})";
    const std::string mesh = R"({"shape": "mesh", "generate": {"mesh": "icosphere", "size": 1}, "material": )";
    const std::string other = R"({"shape": "mesh", "generate": {"mesh": "icosphere", "size": 2}, "material": )";
    const Exported exported(
        scene_text("", materials,
                   mesh + R"("white"},)" + mesh + R"("white", "translate": [3, 0, 0], "scale": 2},)" + mesh +
                       R"("lamp"},)" + other + R"("white"})"),
        "out");
    EXPECT_EQ(exported.command.exit_code, 0) << exported.command.err;
    EXPECT_EQ(exported.command.out, "small: 4 objects, 2 mesh files -> out/small.xml\n");
    EXPECT_EQ(exported.folder.content(),
              (Arguments{"out", "out/small.xml", "out/small_mesh_0.ply", "out/small_mesh_1.ply", "small.json"}));
    const std::string xml = content_of(exported.folder.file("out/small.xml"));
    EXPECT_EQ(
        lines_from(xml, "<shape", 7),
        "<shape type=\"shapegroup\" id=\"mesh_0_1\">\n<shape type=\"ply\">\n"
        "<string name=\"filename\" value=\"small_mesh_0.ply\"/>\n<boolean name=\"face_normals\" value=\"true\"/>\n"
        "<ref name=\"bsdf\" id=\"material_1\"/>\n</shape>\n</shape>\n");
    const std::size_t second = xml.find("<shape type=\"instance\">", xml.find("<shape type=\"instance\">") + 1);
    EXPECT_EQ(lines_from(xml.substr(second), "<shape", 6),
              "<shape type=\"instance\">\n<ref id=\"mesh_0_1\"/>\n<transform name=\"to_world\">\n"
              "<matrix value=\"2 0 0 3 0 2 0 0 0 0 2 0 0 0 0 1\"/>\n</transform>\n</shape>\n");
    EXPECT_EQ(lines_from(xml.substr(xml.find("</shape>", second)), "<shape", 9),
              "<shape type=\"ply\">\n<string name=\"filename\" value=\"small_mesh_0.ply\"/>\n"
              "<boolean name=\"face_normals\" value=\"true\"/>\n<transform name=\"to_world\">\n"
              "<matrix value=\"1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1\"/>\n</transform>\n<ref name=\"bsdf\" "
              "id=\"material_0\"/>\n<emitter type=\"area\">\n<rgb name=\"radiance\" value=\"1, 2, 3\"/>\n");
    const Mesh read = read_mesh(exported.folder.file("out/small_mesh_0.ply"));
    EXPECT_EQ(read.triangles.size(), 80u);
    EXPECT_EQ(read.vertices.size(), 42u);
}

TEST(ExportCommandTest, ImagesAreCopiedBesideTheFile) {
    const std::string tiles = test::in_source("scenes/textures/tiles.png");
    const std::string material = "\"shown\": {\"type\": \"diffuse\", \"albedo\": {\"image\": \"" + tiles + "\"}}";
    const Exported exported(scene_text("", material, R"({"shape": "quad", "material": "shown"})"), "out");
    EXPECT_EQ(exported.command.exit_code, 0) << exported.command.err;
    EXPECT_EQ(exported.folder.content(), (Arguments{"out", "out/small.xml", "out/small_image_0.png", "small.json"}));
    EXPECT_EQ(content_of(exported.folder.file("out/small_image_0.png")), content_of(tiles));
    const Exported box(scene_text("", material, R"({"shape": "box", "material": "shown"})"), "out");
    EXPECT_EQ(box.command.exit_code, 2);
    EXPECT_NE(
        box.command.err.find("small.json: $.objects[0]: found a box with the image " + tiles + ", allowed: a quad, "),
        std::string::npos)
        << box.command.err;
    EXPECT_EQ(box.folder.content(), Arguments{"small.json"});
}

// The scene's own mesh and image have the very names that the export would give to its copies.
TEST(ExportCommandTest, CopiesTakeNobodysPlace) {
    const TemporaryFolder folder;
    write_text(folder.file("small_mesh_0.ply"),
               "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
               "element face 1\nproperty list uchar uint vertex_indices\nend_header\n0 0 0\n1 0 0\n0 2 0\n3 0 1 2\n");
    const std::string tiles = content_of(test::in_source("scenes/textures/tiles.png"));
    const std::string studs = content_of(test::in_source("scenes/textures/studs.png"));
    ASSERT_NE(tiles, studs);
    write_text(folder.file("small_image_0.png"), tiles);
    write_text(folder.file("small_image_1.png"), studs);
    write_text(folder.file("small.json"),
               scene_text("",
                          R"("tiles": {"type": "diffuse", "albedo": {"image": "small_image_0.png"}},
                             "studs": {"type": "diffuse", "albedo": {"image": "small_image_1.png"}},
                             "white": {"type": "diffuse", "albedo": [1, 1, 1]})",
                          R"({"shape": "quad", "material": "tiles"}, {"shape": "quad", "material": "studs"},
                             {"shape": "mesh", "file": "small_mesh_0.ply", "material": "white"})"));
    const auto kept = [&] {
        std::map<std::string, std::string> contents;
        for (const char* name : {"small.json", "small_mesh_0.ply", "small_image_0.png", "small_image_1.png"}) {
            contents[name] = content_of(folder.file(name));
        }
        return contents;
    };
    const auto before = kept();
    const Arguments call{"export", "small.json", "--format", "mitsuba", "--out", "small.xml"};
    for (int times = 0; times < 2; ++times) {
        const CommandResult exported = ptbench(call, {.folder = folder.path()});
        EXPECT_EQ(exported.exit_code, 0) << exported.err;
        EXPECT_EQ(kept(), before);
    }
    const std::string xml = content_of(folder.file("small.xml"));
    EXPECT_NE(xml.find("small_mesh_1.ply"), std::string::npos) << xml;
    EXPECT_EQ(read_mesh(folder.file("small_mesh_1.ply")).triangles.size(), 1u);
    EXPECT_LT(xml.find("small_image_1.png"), xml.find("small_image_2.png"));  // studs as they are, then tiles
    EXPECT_EQ(content_of(folder.file("small_image_2.png")), tiles);
    EXPECT_EQ(folder.content().size(), 7u);
    Arguments other = call;
    other.insert(other.end(), {"--depth", "3"});
    EXPECT_EQ(ptbench(other, {.folder = folder.path()}).exit_code, 2);
    EXPECT_EQ(content_of(folder.file("small.xml")), xml);
    other.emplace_back("--overwrite");
    EXPECT_EQ(ptbench(other, {.folder = folder.path()}).exit_code, 0);
    EXPECT_EQ(kept(), before);
    EXPECT_EQ(folder.content().size(), 7u);
    EXPECT_EQ(ptbench({"render", "--scene", "small.json", "--out", "small_image_0.png"}, {.folder = folder.path()}).err,
              "ptbench: --out: file name: found \"small_image_0.png\", which this call reads, allowed: another file\n");
    EXPECT_EQ(ptbench({"run", "--scene", "small.json", "--out", "small.json", "--overwrite", "--backend", "cpu"},
                      {.folder = folder.path()})
                  .err,
              "ptbench: --out: file name: found \"small.json\", which this call reads, allowed: another file\n");
    EXPECT_EQ(kept(), before);
}

TEST(ExportCommandTest, WrongCallsAreOneLine) {
    const auto refusal = [](const Arguments& added) {
        const Exported exported(scene_text("", white, one_quad), "x.xml", added);
        EXPECT_EQ(exported.command.exit_code, 2);
        EXPECT_EQ(exported.folder.content(), Arguments{"small.json"});
        EXPECT_EQ(std::count(exported.command.err.begin(), exported.command.err.end(), '\n'), 1);
        return exported.command.err;
    };
    EXPECT_EQ(refusal({"--scale", "3"}),
              "ptbench: --scale: argument: found 3, allowed: a power of two from 2^-60 to 2^60, so that no length is "
              "rounded\n");
    EXPECT_EQ(refusal({"--scale", "0"}).find("ptbench: --scale: argument: found 0"), 0u);
    EXPECT_EQ(refusal({"--scale", "nan"}).find("ptbench: --scale: argument: found nan"), 0u);
    const CommandResult other = ptbench({"export", "edge", "--format", "pbrt", "--out", "x.xml"});
    EXPECT_EQ(other.err, "ptbench: --format: argument: found \"pbrt\", allowed: mitsuba\n");
    EXPECT_EQ(other.exit_code, 2);
}

// Lamps that emit on one side only: both sides of a quad, the inside of a room, and through the glass that holds it.
TEST(ExportMitsubaTest, LampsAreAsBrightAsHereFromWhereTheyAreSeen) {
    SceneBuilder builder;
    builder.camera({0, 0, 0}, {0, 0, 1}).image(8, 8, 40, true);
    const std::uint32_t lamp = builder.emitter({1, 2, 4});
    const std::uint32_t glass = builder.dielectric(1.5);
    builder.box(lamp, {0, 0, 0}, {20, 20, 20});
    builder.quad(lamp, {0, -3, 0}, 1, 1);
    builder.sphere(lamp, {0, 0, 5}, 0.5);
    builder.sphere(glass, {0, 0, 5}, 2);
    EXPECT_EQ(mitsuba_problems(builder.scene, "scene", 8), std::vector<std::string>{});
    const std::string xml = mitsuba_scene(builder.scene, {.width = 8, .height = 8}, "scene").xml;
    EXPECT_NE(xml.find("value=\"0.5 0 0 0 0 0 0.5 -2.99"), std::string::npos) << xml;
    EXPECT_NE(xml.find("value=\"0.5 0 0 0 0 0 -0.5 -3.00"), std::string::npos) << xml;
    EXPECT_EQ(lines_from(xml, "<shape type=\"sphere\">", 6),
              "<shape type=\"sphere\">\n<point name=\"center\" x=\"0\" y=\"0\" z=\"5\"/>\n"
              "<float name=\"radius\" value=\"0.25\"/>\n<ref name=\"bsdf\" id=\"material_0\"/>\n"
              "<emitter type=\"area\">\n<rgb name=\"radiance\" value=\"2.25, 4.5, 9\"/>\n");
    EXPECT_EQ(lines_from(xml, "<boolean name=\"flip_normals\"", 3),
              "<boolean name=\"flip_normals\" value=\"true\"/>\n<emitter type=\"area\">\n"
              "<rgb name=\"radiance\" value=\"1, 2, 4\"/>\n");
}

TEST(ExportMitsubaTest, ALampThatCutsGlassIsRefused) {
    SceneBuilder builder;
    builder.camera({0, 0, 0}, {0, 0, 1}).image(8, 8, 40, true);
    const std::uint32_t lamp = builder.emitter({1, 2, 4});
    builder.sphere(builder.dielectric(1.5), {0, 0, 5}, 2);
    builder.box(lamp, {0, 0, 6}, {1, 1, 1});
    EXPECT_EQ(mitsuba_problems(builder.scene, "scene", 8).size(), 1u);
    builder.scene.materials[1].ior = 1;
    EXPECT_EQ(mitsuba_problems(builder.scene, "scene", 8).size(), 0u);
    builder.scene.materials[1].ior = 1.5;
    builder.scene.objects[1].translate = {1.2, 1.2, 6.2};  // the box round the sphere is still met
    EXPECT_EQ(mitsuba_problems(builder.scene, "scene", 8).size(), 0u);
}

TEST(ExportMitsubaTest, MediaAreScaledWithTheScene) {
    SceneBuilder builder;
    builder.camera({0, 0, 0}, {0, 0, 1});
    builder.sphere(builder.dielectric(1.25, {0.5, 1, 2}, {1, 0.5, 0.25}), {0, 0, 5}, 2);
    const std::string xml = mitsuba_scene(builder.scene, {.width = 8, .height = 8, .scale = 2}, "scene").xml;
    EXPECT_NE(xml.find("<integrator type=\"volpath\">"), std::string::npos);
    EXPECT_EQ(lines_from(xml, "<bsdf", 4),
              "<bsdf type=\"dielectric\" id=\"material_0\">\n<float name=\"int_ior\" value=\"1.25\"/>\n"
              "<float name=\"ext_ior\" value=\"1\"/>\n"
              "<rgb name=\"specular_transmittance\" value=\"1, 0.5, 0.25\"/>\n");
    EXPECT_EQ(lines_from(xml, "<medium", 4),
              "<medium name=\"interior\" type=\"homogeneous\">\n<rgb name=\"sigma_t\" value=\"0.25, 0.5, 1\"/>\n"
              "<float name=\"scale\" value=\"1\"/>\n<rgb name=\"albedo\" value=\"0, 0, 0\"/>\n");
}

TEST(ExportCommandTest, ABodyIsAMediumAndPathsHaveNoEnd) {
    const std::string materials =
        R"("wax": {"type": "subsurface", "sigma_a": [0.5, 0, 1], "sigma_s": [1.5, 0, 3], "g": 0.25},
           "soap": {"type": "subsurface", "sigma_s": [1, 1, 1], "ior": 1.25})";
    const std::string objects = R"({"shape": "sphere", "material": "soap"},
           {"shape": "sphere", "material": "wax", "translate": [0, 3, 0]})";
    const Exported exported(scene_text("", materials, objects), "small.xml", {"--depth", "1000", "--scale", "2"});
    EXPECT_EQ(exported.command.exit_code, 0) << exported.command.err;
    const std::string xml = content_of(exported.folder.file("small.xml"));
    EXPECT_EQ(lines_from(xml, "<integrator", 3),
              "<integrator type=\"volpathmis\">\n<integer name=\"max_depth\" value=\"-1\"/>\n"
              "<integer name=\"rr_depth\" value=\"300\"/>\n");
    EXPECT_EQ(lines_from(xml, "<bsdf", 5),
              "<bsdf type=\"dielectric\" id=\"material_0\">\n<float name=\"int_ior\" value=\"1.25\"/>\n"
              "<float name=\"ext_ior\" value=\"1\"/>\n</bsdf>\n<bsdf type=\"null\" id=\"material_1\"/>\n");
    EXPECT_EQ(lines_from(xml.substr(xml.rfind("<medium")), "<medium", 8),
              "<medium name=\"interior\" type=\"homogeneous\">\n<rgb name=\"sigma_t\" value=\"0.5, 0, 1\"/>\n"
              "<float name=\"scale\" value=\"2\"/>\n<rgb name=\"albedo\" value=\"0.75, 0, 0.75\"/>\n"
              "<phase type=\"hg\">\n<float name=\"g\" value=\"0.25\"/>\n</phase>\n</medium>\n");
}

// 128 and what a step must be taken to for 10^-5 to be left: a decay of pi^2 / (3 L^2), L the diameter in mean free
// paths and 6; in a white body of 94 there is no other one, and an albedo of 0.99 adds ln(1 / 0.99) to it.
TEST(ExportMitsubaTest, RouletteBeginsWhereWalksInDenseBodiesHaveEnded) {
    const auto begins = [](const Vec3d& sigma_s, const Vec3d& sigma_a, double diameter) {
        SceneBuilder builder;
        builder.camera({0, 0, 0}, {0, 0, 1});
        builder.sphere(builder.subsurface(sigma_s, sigma_a), {0, 0, 500}, diameter);
        const std::string xml = mitsuba_scene(builder.scene, {.width = 8, .height = 8, .depth = 1000}, "scene").xml;
        const std::string before = "\"rr_depth\" value=\"";
        return std::stoul(xml.substr(xml.find(before) + before.size()));
    };
    EXPECT_EQ(begins({47, 0.5, 0}, {0, 0, 0}, 2), 128u + 34996u);
    EXPECT_EQ(begins({4.7, 0.5, 0}, {0, 0, 0}, 20), 128u + 34996u);
    EXPECT_EQ(begins({0.99, 0, 0}, {0.01, 0, 0}, 94), 128u + 1110u);
}

TEST(XmlTextTest, WhatXmlCannotHoldIsEscaped) {
    EXPECT_EQ(xml_escaped("a<b>&\"c'\n\t\x01 \xc3\xa4"), "a&lt;b&gt;&amp;&quot;c'&#10;&#9;? \xc3\xa4");
    XmlText xml;
    xml.open("a", {{"b", "<"}});
    xml.leaf("c", {});
    xml.close();
    EXPECT_EQ(xml.text(), "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<a b=\"&lt;\">\n  <c/>\n</a>\n");
}

}  // namespace
}  // namespace pt::test
