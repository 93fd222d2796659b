// Mitsuba's XML: what each part is read as, by formulas of that program's documentation and source, and what is told.
#include "harness/interchange/import_mitsuba.h"

#include <cmath>
#include <filesystem>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "harness/interchange/affine.h"
#include "harness/interchange/import_scene.h"
#include "harness/interchange/mitsuba_indices.h"
#include "harness/interchange/mitsuba_object.h"
#include "harness/interchange/xml_document.h"
#include "harness/mesh/write_mesh.h"
#include "tests/support/command.h"
#include "tests/support/places.h"

namespace pt::test {
namespace {

const std::string integrator = R"(<integrator type="path"><integer name="max_depth" value="5"/></integrator>)";
const std::string film =
    R"(<film type="hdrfilm"><integer name="width" value="40"/><integer name="height" value="20"/><rfilter type="box"/></film>)";
const std::string view =
    R"(<transform name="to_world"><lookat origin="0, 0, 9" target="0 0 0" up="0,1,0"/></transform>)";
const std::string fov = R"(<float name="fov" value="40"/><string name="fov_axis" value="y"/>)";

std::string sensor(const std::string& content) { return "<sensor type=\"perspective\">\n" + content + "</sensor>\n"; }

// Each part in a line of its own, from line 2 on.
std::string scene_of(const std::string& content, const std::string& in_sensor = view + fov + film) {
    return "<scene version=\"3.0.0\">\n" + integrator + sensor(in_sensor) + content + "\n</scene>\n";
}

struct Mitsuba {
    explicit Mitsuba(const std::string& text, const std::string& file = "there.xml")
        : result(import_mitsuba({.text = text, .file = file, .out = "back.json", .name = ""})) {
        if (!result.json.empty()) {
            scene = parse_scene(result.json, "back.json");
        }
    }
    std::vector<std::string> problems() const { return result.problems.messages("f", ""); }
    std::vector<std::string> warnings() const { return result.warnings.messages("f", ""); }
    std::vector<std::string> notes() const { return result.notes.messages("f", ""); }
    const SceneMaterial& material(std::size_t object = 0) const {
        return scene.materials[scene.objects.at(object).material];
    }

    ImportResult result;
    Scene scene;
};

using Lines = std::vector<std::string>;

class ImportMitsubaTest : public testing::Test {
protected:
    void SetUp() override {
        if (!reads_xml()) {
            GTEST_SKIP() << "this build has no reader for XML";
        }
    }
};

TEST_F(ImportMitsubaTest, AWholeSceneAndNothingToTell) {
    const Mitsuba read(scene_of(R"(<emitter type="constant"><rgb name="radiance" value="1 2 3"/></emitter>
<bsdf type="twosided" id="wall"><bsdf type="diffuse"><rgb name="reflectance" value="0.25, 0.5, 0.75"/></bsdf></bsdf>
<shape type="sphere"><point name="center" x="1" y="2" z="3"/><float name="radius" value="0.5"/><ref id="wall"/></shape>
<shape type="cube"><ref id="wall"/></shape>
<shape type="rectangle"><transform name="to_world"><rotate x="1" angle="-90"/><scale value="5"/></transform><ref id="wall"/></shape>)"));
    EXPECT_EQ(read.problems(), Lines());
    EXPECT_EQ(read.warnings(), Lines());
    EXPECT_EQ(read.notes(), Lines());
    EXPECT_EQ(read.scene.name, "there");
    EXPECT_EQ(read.scene.max_depth, 5u);
    EXPECT_EQ(read.scene.environment, Vec3d(1, 2, 3));
    EXPECT_EQ(read.scene.camera.eye, Vec3d(0, 0, 9));
    EXPECT_EQ(read.scene.camera.look_at, Vec3d(0, 0, 0));
    EXPECT_EQ(read.scene.camera.up, Vec3d(0, 1, 0));
    EXPECT_EQ(read.scene.camera.vertical_fov_degrees, 40);
    EXPECT_EQ(read.scene.camera.width, 40u);
    EXPECT_EQ(read.scene.camera.height, 20u);
    ASSERT_EQ(read.scene.objects.size(), 3u);
    EXPECT_EQ(read.material().name, "wall");
    EXPECT_EQ(read.material().albedo, Vec3d(0.25, 0.5, 0.75));
    const SceneObject &sphere = read.scene.objects[0], &cube = read.scene.objects[1], &floor = read.scene.objects[2];
    EXPECT_EQ(sphere.translate, Vec3d(1, 2, 3));
    EXPECT_EQ(sphere.scale, Vec3d(1.0));
    EXPECT_EQ(cube.scale, Vec3d(2.0));
    // Mitsuba's rectangle lies in xy and faces +z; turned so that it faces +y, it is a quad as it lies here.
    EXPECT_EQ(floor.shape, Shape::quad);
    EXPECT_EQ(floor.scale, Vec3d(10.0));
    EXPECT_EQ(floor.rotate_degrees, Vec3d(0.0));
    EXPECT_EQ(read.result.objects, 3u);
    EXPECT_EQ(read.result.materials, 1u);
}

TEST_F(ImportMitsubaTest, TheFieldOfViewIsVerticalHere) {
    const auto vertical = [](const std::string& content) {
        const Mitsuba read(scene_of("", view + film + content));
        EXPECT_EQ(read.problems(), Lines());
        return read.scene.camera.vertical_fov_degrees;
    };
    const auto from_tangent = [](double tangent) { return 2 * std::atan(tangent) * (180 / pi<double>); };
    const double half = std::tan(30 * (pi<double> / 180)), aspect = 2;
    const std::string sixty = R"(<float name="fov" value="60"/>)";
    EXPECT_NEAR(vertical(sixty), from_tangent(half / aspect), 1e-12);  // x is the default
    EXPECT_EQ(vertical(sixty + R"(<string name="fov_axis" value="Y"/>)"), 60);
    EXPECT_EQ(vertical(sixty + R"(<string name="fov_axis" value="smaller"/>)"), 60);
    EXPECT_NEAR(vertical(sixty + R"(<string name="fov_axis" value="larger"/>)"), from_tangent(half / aspect), 1e-12);
    EXPECT_NEAR(vertical(sixty + R"(<string name="fov_axis" value="diagonal"/>)"),
                from_tangent(half / std::sqrt(1 + aspect * aspect)), 1e-12);
    // A frame of 36 x 24 mm, by its diagonal.
    const double diagonal = std::sqrt(36.0 * 36 + 24 * 24) / (2 * 35);
    EXPECT_NEAR(vertical(R"(<string name="focal_length" value="35mm"/>)"),
                from_tangent(diagonal / std::sqrt(1 + aspect * aspect)), 1e-12);
    EXPECT_NEAR(vertical(""), from_tangent(diagonal * 35 / 50 / std::sqrt(1 + aspect * aspect)), 1e-12);
}

TEST_F(ImportMitsubaTest, AMatrixLooksAlongItsThirdColumn) {
    const Mitsuba read(scene_of(
        "", R"(<transform name="to_world"><matrix value="-1 0 0 1  0 1 0 2  0 0 -1 3  0 0 0 1"/></transform>)" + fov +
                film));
    EXPECT_EQ(read.problems(), Lines());
    EXPECT_EQ(read.scene.camera.eye, Vec3d(1, 2, 3));
    EXPECT_EQ(read.scene.camera.look_at, Vec3d(1, 2, 2));
    EXPECT_EQ(read.scene.camera.up, Vec3d(0, 1, 0));
    // The first column of Mitsuba's look_at is left: such a view is not mirrored, and that of the unit matrix looks
    // along +z.
    const Affine looking = look_at_map({1, 2, 3}, {1, 2, 0}, {0, 1, 0});
    EXPECT_EQ(looking.column[0], Vec3d(-1, 0, 0));
    EXPECT_EQ(looking.column[2], Vec3d(0, 0, -1));
    const Mitsuba mirrored(scene_of("", R"(<transform name="to_world"><scale x="-1"/></transform>)" + fov + film));
    EXPECT_EQ(
        mirrored.problems(),
        Lines{"f:3: found <transform name=\"to_world\">, allowed: for a sensor, a transform that does not mirror: "
              "no picture here is the wrong way round"});
}

TEST_F(ImportMitsubaTest, ALensHasItsRadiusAndDistance) {
    std::string text = scene_of("", view + fov + film + R"(<float name="aperture_radius" value="0.25"/>
<float name="focus_distance" value="7"/>)");
    text.replace(text.find("perspective"), 11, "thinlens");
    const Mitsuba read(text);
    EXPECT_EQ(read.problems(), Lines());
    EXPECT_EQ(read.scene.camera.aperture_radius, 0.25);
    EXPECT_EQ(read.scene.camera.focus_distance, 7);
}

const std::string ball = R"(<shape type="sphere"><bsdf type=)";

TEST_F(ImportMitsubaTest, MaterialsByTheirParameters) {
    const Mitsuba mirror(
        scene_of(ball + R"("conductor"><rgb name="specular_reflectance" value="0.5"/></bsdf></shape>)"));
    EXPECT_EQ(mirror.warnings(), Lines());
    EXPECT_EQ(mirror.material().type, MaterialType::mirror);
    EXPECT_EQ(mirror.material().reflectance, Vec3d(0.5));
    const Mitsuba glass(scene_of(
        ball + R"("dielectric"><float name="int_ior" value="1.5"/><float name="ext_ior" value="1"/></bsdf></shape>)"));
    EXPECT_EQ(glass.notes(), Lines());
    EXPECT_EQ(glass.material().type, MaterialType::dielectric);
    EXPECT_EQ(glass.material().ior, 1.5);
    const Mitsuba water(scene_of(ball + R"("dielectric"><string name="int_ior" value="Water"/></bsdf></shape>)"));
    EXPECT_EQ(water.material().ior, 1.333 / 1.000277);
    EXPECT_EQ(water.notes(),
              Lines{fmt::format("f:4: <bsdf type=\"dielectric\"> has the index 1.333 in 1.000277: here {} in 1",
                                1.333 / 1.000277)});
    const Mitsuba bare(scene_of(R"(<shape type="sphere"/>)"));
    EXPECT_EQ(bare.material().albedo, Vec3d(0.5));
}

TEST_F(ImportMitsubaTest, RoughnessIsTheRootOfAlpha) {
    const Mitsuba ggx(scene_of(ball + R"("roughconductor"><string name="distribution" value="ggx"/>
<float name="alpha" value="0.09"/></bsdf></shape>)"));
    EXPECT_EQ(ggx.material().type, MaterialType::rough_conductor);
    EXPECT_EQ(ggx.material().roughness, 0.3);
    EXPECT_EQ(ggx.material().reflectance, Vec3d(1.0));
    EXPECT_EQ(ggx.warnings(),
              Lines{"f:4: <bsdf type=\"roughconductor\"> is read with facets masked for both directions together, "
                    "there for each on its own"});
    const Mitsuba frosted(scene_of(ball + R"("roughdielectric"><float name="alpha" value="0.25"/></bsdf></shape>)"));
    EXPECT_EQ(frosted.material().type, MaterialType::rough_dielectric);
    EXPECT_EQ(frosted.material().roughness, 0.5);
    ASSERT_EQ(frosted.warnings().size(), 1u);
    EXPECT_NE(frosted.warnings()[0].find("by GGX, not by Beckmann"), std::string::npos);
    const Mitsuba uneven(scene_of(ball + R"("roughconductor"><float name="alpha_u" value="0.1"/>
<float name="alpha_v" value="0.2"/></bsdf></shape>)"));
    EXPECT_EQ(uneven.problems().size(), 1u);
}

TEST_F(ImportMitsubaTest, MetalsHaveTheirReflectanceAtNormalIncidence) {
    const MitsubaMetal& gold = *find_mitsuba_metal("Au");
    const Mitsuba named(scene_of(ball + R"("roughconductor"><string name="material" value="Au"/></bsdf></shape>)"));
    for (int i = 0; i < 3; ++i) {
        // |(n - 1 + ik) / (n + 1 + ik)|^2
        const double expected = (std::pow(gold.eta[i] - 1, 2) + std::pow(gold.k[i], 2)) /
                                (std::pow(gold.eta[i] + 1, 2) + std::pow(gold.k[i], 2));
        EXPECT_NEAR(named.material().reflectance[i], expected, 1e-15);
    }
    const Mitsuba unknown(scene_of(ball + R"("conductor"><string name="material" value="CsI"/></bsdf></shape>)"));
    ASSERT_EQ(unknown.problems().size(), 1u);
    EXPECT_NE(unknown.problems()[0].find("\"none\" or Ag, Al, Au, "), std::string::npos);
}

TEST_F(ImportMitsubaTest, MediaAbsorbOrScatter) {
    const std::string inside =
        R"("dielectric"><float name="int_ior" value="1.5"/><float name="ext_ior" value="1"/></bsdf>
<medium type="homogeneous" name="interior"><rgb name="sigma_t" value="0.5, 0.25, 1"/><float name="scale" value="4"/>)";
    const Mitsuba ink(scene_of(ball + inside + R"(<rgb name="albedo" value="0"/></medium></shape>)"));
    EXPECT_EQ(ink.warnings(), Lines());
    EXPECT_EQ(ink.material().sigma_a, Vec3d(2, 1, 4));
    const Mitsuba wax(scene_of(ball + inside + R"(<rgb name="albedo" value="0.75"/><phase type="hg">
<float name="g" value="0.5"/></phase></medium></shape>)"));
    EXPECT_EQ(wax.material().type, MaterialType::subsurface);
    EXPECT_EQ(wax.material().sigma_s, Vec3d(1.5, 0.75, 3));
    EXPECT_EQ(wax.material().sigma_a, Vec3d(0.5, 0.25, 1));
    EXPECT_EQ(wax.material().g, 0.5);
    EXPECT_EQ(wax.warnings().size(), 1u);
}

TEST_F(ImportMitsubaTest, AFlatSpectrumOfAnEmitterIsNotGrey) {
    const Mitsuba read(scene_of(R"(<emitter type="constant"><spectrum name="radiance" value="2"/></emitter>)"));
    // The numbers are those that Mitsuba 3.9.1 has in scalar_rgb, in single precision.
    EXPECT_NEAR(read.scene.environment.x, 2 * 1.204793, 1e-5);
    EXPECT_NEAR(read.scene.environment.y, 2 * 0.948292, 1e-5);
    EXPECT_NEAR(read.scene.environment.z, 2 * 0.908917, 1e-5);
    EXPECT_EQ(read.notes().size(), 1u);
}

TEST_F(ImportMitsubaTest, AnAxisThatIsNotOfLengthOneIsTold) {
    const Mitsuba read(
        scene_of(R"(<shape type="cube"><transform name="to_world"><rotate y="2" angle="30"/></transform></shape>)"));
    EXPECT_EQ(read.scene.objects.at(0).rotate_degrees, Vec3d(0, 30, 0));
    EXPECT_EQ(read.warnings().size(), 1u);
}

TEST_F(ImportMitsubaTest, ABlendIsAMix) {
    const Mitsuba read(scene_of(ball + R"("blendbsdf"><float name="weight" value="0.25"/><bsdf type="diffuse"/>
<bsdf type="conductor"/></bsdf></shape>)"));
    EXPECT_EQ(read.material().type, MaterialType::mix);
    EXPECT_EQ(read.material().mirror_probability, 0.25);
    EXPECT_EQ(read.material().albedo, Vec3d(0.5));
    EXPECT_EQ(read.warnings().size(), 1u);
}

TEST_F(ImportMitsubaTest, ALampOfOneSideHasAQuadBehindIt) {
    const std::string lamp =
        R"(<shape type="rectangle"><emitter type="area"><rgb name="radiance" value="4"/></emitter></shape>)";
    const Mitsuba read(scene_of(lamp + R"(<shape type="sphere"/>)"));
    ASSERT_EQ(read.scene.objects.size(), 3u);
    EXPECT_EQ(read.material(0).type, MaterialType::emitter);
    EXPECT_EQ(read.material(0).emission, Vec3d(4.0));
    const SceneObject &front = read.scene.objects[0], &back = read.scene.objects[2];
    EXPECT_EQ(front.translate, Vec3d(0.0));
    EXPECT_EQ(back.translate, Vec3d(0, 0, -std::ldexp(10.0, -16)));  // the sphere's far side is 10 from the eye
    EXPECT_EQ(back.scale, front.scale);
    EXPECT_EQ(read.material(2).type, MaterialType::diffuse);
    EXPECT_EQ(read.material(2).albedo, Vec3d(0.0));
    EXPECT_EQ(read.notes().size(), 1u);
    // Turned about, it shines to the other side.
    const Mitsuba flipped(scene_of(R"(<shape type="rectangle"><boolean name="flip_normals" value="true"/>
<emitter type="area"><rgb name="radiance" value="4"/></emitter></shape>)"));
    EXPECT_GT(flipped.scene.objects.at(1).translate.z, 0);
}

TEST_F(ImportMitsubaTest, SidesThatDifferAreTold) {
    const Mitsuba read(scene_of(R"(<bsdf type="diffuse" id="wall"/>
<shape type="rectangle"><ref id="wall"/></shape>
<shape type="sphere"><ref id="wall"/></shape>
<shape type="cube"><transform name="to_world"><scale value="20"/></transform>
<emitter type="area"><rgb name="radiance" value="4"/></emitter></shape>)"));
    EXPECT_EQ(
        read.warnings(),
        (Lines{"f:4: <bsdf type=\"diffuse\" id=\"wall\"> reflects on both sides here, there on the front only, and "
               "1 shape can be seen from behind (twosided is the same in both)",
               "f:7: <shape type=\"cube\"> shines to both sides here, there only outwards, and the eye is "
               "inside"}));
}

TEST_F(ImportMitsubaTest, ALampInGlassIsDimmedByTheSquareOfTheIndex) {
    const Mitsuba read(scene_of(R"(<shape type="sphere"><float name="radius" value="2"/><bsdf type="dielectric">
<float name="int_ior" value="2"/><float name="ext_ior" value="1"/></bsdf></shape>
<shape type="sphere"><emitter type="area"><rgb name="radiance" value="4, 8, 16"/></emitter></shape>)"));
    EXPECT_EQ(read.problems(), Lines());
    EXPECT_EQ(read.material(1).emission, Vec3d(1, 2, 4));
    EXPECT_EQ(read.notes().size(), 1u);
    const Mitsuba within(scene_of(R"(<shape type="sphere"><float name="radius" value="20"/><bsdf type="dielectric">
<float name="int_ior" value="2"/><float name="ext_ior" value="1"/></bsdf></shape>)"));
    ASSERT_EQ(within.warnings().size(), 1u);
    EXPECT_NE(within.warnings()[0].find("a dielectric with the eye inside"), std::string::npos);
}

const std::string tiles = test::in_source("scenes/textures/tiles.png");

// A BSDF with an image, and what else its texture has.
std::string with_image(const std::string& more = "", const std::string& file = tiles) {
    return fmt::format(
        "<bsdf type=\"twosided\" id=\"tiles\"><bsdf type=\"diffuse\"><texture type=\"bitmap\" name=\"reflectance\">"
        "<string name=\"filename\" value=\"{}\"/>{}</texture></bsdf></bsdf>\n",
        file, more);
}

// The XML of a shape whose BSDF is the one with the id "tiles".
std::string shown_on(const std::string& type, const std::string& content = "") {
    return fmt::format("<shape type=\"{}\">{}<ref id=\"tiles\"/></shape>", type, content);
}

std::string named_file(const std::string& file) {
    return fmt::format("<string name=\"filename\" value=\"{}\"/><boolean name=\"face_normals\" value=\"true\"/>", file);
}

const std::string v_turned = R"(<transform name="to_uv"><scale x="1" y="-1"/></transform>)";

// The place in the scene of a point of the object's own space.
Vec3d placed_point(const SceneObject& object, const Vec3d& p) {
    const Rotation rotation = rotation_of(object.rotate_degrees);
    return object.translate + rotation.column[0] * (object.scale.x * p.x) +
           rotation.column[1] * (object.scale.y * p.y) + rotation.column[2] * (object.scale.z * p.z);
}

// Mitsuba's (u, v) of a rectangle is ((x + 1) / 2, (y + 1) / 2), and v = 0 the image's first row; here (0, 0), in a
// quad's own space (-1/2, 0, 1/2), is the lower left corner.
TEST_F(ImportMitsubaTest, AnImageOnARectangleLiesAsItDoesThere) {
    for (const bool is_turned : {false, true}) {
        const Mitsuba read(scene_of(with_image(is_turned ? v_turned : "") + shown_on("rectangle")));
        ASSERT_EQ(read.problems(), Lines());
        EXPECT_EQ(read.warnings(), Lines());
        ASSERT_NE(read.material().texture, nullptr);
        EXPECT_TRUE(std::filesystem::equivalent(read.material().texture->path, tiles));
        const double last_row = is_turned ? -1 : 1;  // its y
        EXPECT_EQ(placed_point(read.scene.objects[0], {-0.5, 0, 0.5}), Vec3d(-1, last_row, 0));
        EXPECT_EQ(placed_point(read.scene.objects[0], {0.5, 0, -0.5}), Vec3d(1, -last_row, 0));
    }
}

// u is atan2(y, x) / 2 pi and v is acos(z) / pi; here the image's middle is at +z, three quarters of its width at +x,
// and its first row at +y.
TEST_F(ImportMitsubaTest, AnImageOnASphereLiesAsItDoesThere) {
    const Mitsuba read(scene_of(with_image() + shown_on("sphere")));
    ASSERT_EQ(read.problems(), Lines());
    const SceneObject& sphere = read.scene.objects.at(0);
    EXPECT_EQ(placed_point(sphere, {0, 0, 0.5}), Vec3d(-1, 0, 0));
    EXPECT_EQ(placed_point(sphere, {0.5, 0, 0}), Vec3d(0, -1, 0));
    EXPECT_EQ(placed_point(sphere, {0, 0.5, 0}), Vec3d(0, 0, 1));
}

// Mitsuba's v is the file's for a PLY, and 1 - v for an OBJ; and it is downwards, unless to_uv turns it.
TEST_F(ImportMitsubaTest, AnImageOnAMeshLiesAsItDoesThere) {
    const TemporaryFolder folder;
    Mesh mesh;
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.triangles = {{0, 1, 2}};
    mesh.coordinates = {{{{0, 0}, {1, 0}, {0, 0.25f}}}};
    const auto expect_rows = [&](const std::string& kind, const std::string& flip, bool is_turned) {
        const std::string flips =
            flip.empty() ? "" : fmt::format(R"(<boolean name="flip_tex_coords" value="{}"/>)", flip);
        const std::string content =
            with_image(is_turned ? v_turned : "") + shown_on(kind, named_file(folder.file("a." + kind)) + flips);
        const ImportResult result = import_mitsuba(
            {.text = scene_of(content), .file = folder.file("there.xml"), .out = folder.file("back.json"), .name = ""});
        ASSERT_EQ(result.problems.messages("f", ""), Lines());
        const bool is_flipped = flip.empty() ? kind == "obj" : flip == "true";
        ASSERT_EQ(result.meshes.size(), is_flipped == is_turned ? 1u : 0u);
        const auto& corners = result.meshes.empty() ? mesh.coordinates : result.meshes[0].mesh.coordinates;
        for (std::size_t i = 0; i < 3; ++i) {
            const float in_file = mesh.coordinates[0][i][1];
            const float down = (is_flipped ? 1 - in_file : in_file) * (is_turned ? -1.0f : 1.0f);
            const float v = corners[0][i][1], expected = 1 - down;  // but for whole images
            EXPECT_EQ(v - std::floor(v), expected - std::floor(expected)) << kind << flip << is_turned;
        }
    };
    for (const std::string kind : {"ply", "obj"}) {
        write_mesh(mesh, folder.file("a." + kind));
        for (const std::string flip : {"", "true", "false"}) {
            expect_rows(kind, flip, false);
            expect_rows(kind, flip, true);
        }
    }
}

TEST_F(ImportMitsubaTest, ImagesThatCannotBeShownAreRefused) {
    const auto problem = [](const std::string& content) {
        const Mitsuba read(scene_of(content));
        EXPECT_EQ(read.problems().size(), 1u) << content;
        return read.problems().empty() ? "" : read.problems()[0];
    };
    const std::string quad = shown_on("rectangle");
    EXPECT_TRUE(problem(with_image("", "missing.png") + quad)
                    .starts_with("f:4: found <string name=\"filename\" value=\"missing.png\">, allowed: an image that "
                                 "can be read (missing.png"));
    EXPECT_EQ(problem(with_image(R"(<string name="filter_type" value="nearest"/>)") + quad),
              "f:4: found <string name=\"filter_type\" value=\"nearest\">, allowed: bilinear: texels are blended here");
    EXPECT_EQ(problem(with_image(R"(<string name="wrap_mode" value="clamp"/>)") + quad),
              "f:4: found <string name=\"wrap_mode\" value=\"clamp\">, allowed: repeat: images repeat here");
    EXPECT_EQ(problem(with_image(R"(<boolean name="raw" value="true"/>)") + quad),
              "f:4: found <boolean name=\"raw\" value=\"true\">, allowed: false: the values of an image are sRGB here");
    EXPECT_EQ(problem(with_image(R"(<transform name="to_uv"><scale value="2"/></transform>)") + quad),
              "f:4: found <transform name=\"to_uv\">, allowed: none, or a scale by 1 and -1");
    EXPECT_EQ(
        problem(with_image() + shown_on("cube")),
        "f:5: found <shape type=\"cube\">, allowed: an image on a rectangle, a sphere or a mesh: on a cube it lies "
        "in another way here");
    EXPECT_EQ(
        problem(with_image(v_turned) + shown_on("sphere")),
        "f:5: found <shape type=\"sphere\">, allowed: a sphere that is not mirrored, with a texture without to_uv");
    const std::string lamp = R"(<emitter type="area"><rgb name="radiance" value="1"/></emitter>)";
    EXPECT_EQ(problem(with_image() + shown_on("rectangle", lamp)),
              "f:5: found <shape type=\"rectangle\">, allowed: on a rectangle, an image or an emitter");
    const TemporaryFolder folder;
    write_text(folder.file("a.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    EXPECT_EQ(problem(with_image() + shown_on("obj", named_file(folder.file("a.obj")))),
              "f:5: found <shape type=\"obj\">, allowed: a mesh with texture coordinates, since its BSDF has an image");
}

TEST_F(ImportMitsubaTest, EverythingThatIsNotReadIsListedAtOnce) {
    const Mitsuba read(scene_of(R"(<emitter type="envmap"/>
<include filename="other.xml"/>
<shape type="disk"/>
<shape type="sphere"><bsdf type="plastic"/></shape>
<shape type="sphere"><bsdf type="diffuse"><texture type="checkerboard" name="reflectance"/></bsdf></shape>
<shape type="sphere"><float name="radius" value="x"/></shape>
<shape type="sphere"><bsdf type="diffuse"><rgb name="reflectance" value="2 0 0"/></bsdf></shape>
<shape type="cube"><transform name="to_world"><matrix value="1 1 0 0 0 1 0 0 0 0 1 0 0 0 0 1"/></transform></shape>
<shape type="ply"><string name="filename" value="missing.ply"/></shape>
<shape type="sphere"><ref id="nobody"/></shape>)"));
    EXPECT_EQ(read.result.json, "");
    std::vector<std::string> starts;
    for (const std::string& problem : read.problems()) {
        starts.push_back(problem.substr(0, problem.find(", allowed")));
    }
    EXPECT_EQ(
        starts,
        (Lines{
            "f:4: found <emitter type=\"envmap\">", "f:5: found <include filename=\"other.xml\">",
            "f:6: found <shape type=\"disk\">", "f:7: found <bsdf type=\"plastic\">",
            "f:8: found <texture type=\"checkerboard\" name=\"reflectance\">",
            "f:9: found <float name=\"radius\" value=\"x\">",
            "f:10: found \"<rgb name=\"reflectance\" value=\"2 0 0\">\", which makes $.materials.diffuse.albedo[0] 2",
            "f:11: found <shape type=\"cube\">", "f:12: found <string name=\"filename\" value=\"missing.ply\">",
            "f:13: found <ref id=\"nobody\">"}));
}

TEST_F(ImportMitsubaTest, WhatARunOrARoundingDecidesIsTold) {
    std::string text = scene_of("<bsdf type=\"diffuse\" id=\"spare\"/>",
                                view + fov + R"(<film type="hdrfilm"/><sampler type="multijitter"/>)");
    text.replace(text.find("value=\"5\""), 9, "value=\"-1\"");
    const Mitsuba read(text);
    EXPECT_EQ(read.scene.camera.width, 768u);
    EXPECT_EQ(read.scene.camera.height, 576u);
    EXPECT_EQ(read.scene.max_depth, 64u);
    EXPECT_EQ(
        read.warnings(),
        (Lines{"f:2: <integer name=\"max_depth\" value=\"-1\"> has paths without end: here they end at max_depth 64",
               "f:3: <film type=\"hdrfilm\"> blurs: here a pixel is the mean of its own square, as with <rfilter "
               "type=\"box\"/>"}));
    EXPECT_EQ(read.notes(),
              (Lines{"f:3: <sampler type=\"multijitter\"> is left out: how many samples a pixel gets, and how they are "
                     "drawn, is a run's business",
                     "f:4: <bsdf type=\"diffuse\" id=\"spare\"> is left out: no shape has it"}));
}

TEST_F(ImportMitsubaTest, ParametersHaveTheirDefaults) {
    const Mitsuba read(R"(<scene version="3.0.0"><default name="d" value="7"/><default name="depth" value="3"/>
<default name="d" value="8"/><integrator type="path"><integer name="max_depth" value="$depth"/></integrator>)" +
                       sensor(view + fov + film) +
                       R"(<shape type="sphere"><float name="radius" value="0.$d"/></shape></scene>)");
    EXPECT_EQ(read.problems(), Lines());
    EXPECT_EQ(read.scene.max_depth, 3u);
    EXPECT_EQ(read.scene.objects.at(0).scale, Vec3d(1.4));
    const Mitsuba without(scene_of(R"(<shape type="sphere"><float name="radius" value="$r"/></shape>)"));
    EXPECT_EQ(without.problems().size(), 2u);
}

TEST_F(ImportMitsubaTest, NamesOfOldFilesAreRead) {
    std::string text = scene_of("");
    text.replace(text.find("3.0.0"), 5, "0.6.0");
    text.replace(text.find("max_depth"), 9, "maxDepth");
    text.replace(text.find("to_world"), 8, "toWorld");
    const Mitsuba read(text);
    EXPECT_EQ(read.problems(), Lines());
    EXPECT_EQ(read.scene.max_depth, 5u);
    EXPECT_EQ(read.scene.camera.eye, Vec3d(0, 0, 9));
}

TEST_F(ImportMitsubaTest, MeshesAreNamedFromTheSceneFileAndMirrorsAreWritten) {
    const TemporaryFolder folder;
    Mesh triangle;
    triangle.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}};
    triangle.triangles = {{0, 1, 2}};
    std::filesystem::create_directory(folder.path() / "in");
    write_mesh(triangle, folder.file("in/t.ply"));
    const std::string mesh = R"(<string name="filename" value="t.ply"/><boolean name="face_normals" value="true"/>)";
    const std::string text =
        scene_of(R"(<shape type="ply"><transform name="to_world"><translate x="1"/></transform>)" + mesh +
                 R"(<bsdf type="twosided"><bsdf type="diffuse"/></bsdf></shape>
<shape type="shapegroup" id="g"><shape type="ply">)" +
                 mesh + R"(<bsdf type="twosided"><bsdf type="diffuse"/></bsdf></shape></shape>
<shape type="instance"><ref id="g"/><transform name="to_world"><scale x="-3"/></transform></shape>)");
    const ImportResult result =
        import_mitsuba({.text = text, .file = folder.file("in/s.xml"), .out = folder.file("s.json"), .name = "s"});
    EXPECT_EQ(result.problems.messages("f", ""), Lines());
    EXPECT_EQ(result.warnings.messages("f", ""), Lines());
    ASSERT_EQ(result.meshes.size(), 1u);
    EXPECT_EQ(result.meshes[0].file, "s_mesh_0.ply");
    // The outside stays outside: the corners go round the other way.
    EXPECT_EQ(result.meshes[0].mesh.vertices[1][0], -3);
    EXPECT_EQ(result.meshes[0].mesh.triangles[0][1], 2u);
    write_mesh(result.meshes[0].mesh, folder.file("s_mesh_0.ply"));
    const Scene scene = parse_scene(result.json, folder.file("s.json"));
    ASSERT_EQ(scene.objects.size(), 2u);
    EXPECT_EQ(scene.meshes[scene.objects[0].mesh]->source, "t.ply");
    EXPECT_EQ(scene.objects[0].translate, Vec3d(1, 0, 0));
    EXPECT_EQ(scene.meshes[scene.objects[1].mesh]->source, "s_mesh_0.ply");
}

TEST_F(ImportMitsubaTest, EnvironmentImages) {
    const std::string sky = test::in_source("scenes/environments/sky.hdr");
    const auto envmap = [](const std::string& name, const std::string& more = "") {
        return scene_of("<emitter type=\"envmap\"><string name=\"filename\" value=\"" + name + "\"/>" + more +
                        "</emitter>");
    };
    const Mitsuba read(envmap(
        sky, R"(<float name="scale" value="0.5"/><transform name="to_world"><rotate y="1" angle="70"/></transform>)"));
    EXPECT_EQ(read.problems(), Lines());
    EXPECT_EQ(read.warnings().size(), 1u);
    ASSERT_NE(read.scene.environment_map, nullptr);
    EXPECT_EQ(read.scene.environment_map->image.width, 64u);
    EXPECT_EQ(read.scene.environment_map->rotation_degrees, 70);
    EXPECT_EQ(
        Mitsuba(envmap(sky, R"(<transform name="to_world"><rotate x="1" angle="70"/></transform>)")).problems().size(),
        1u);
    const Lines missing = Mitsuba(envmap("nowhere.hdr")).problems();
    ASSERT_EQ(missing.size(), 1u);
    EXPECT_NE(missing[0].find("allowed: an image that can be read"), std::string::npos) << missing[0];
    const Lines two = Mitsuba(scene_of(R"(<emitter type="constant"/><emitter type="envmap"/>)")).problems();
    ASSERT_EQ(two.size(), 1u);
    EXPECT_NE(two[0].find("allowed: one constant emitter or envmap"), std::string::npos) << two[0];
    const Lines sun = Mitsuba(scene_of(R"(<emitter type="sunsky"/>)")).problems();
    ASSERT_EQ(sun.size(), 1u);
    EXPECT_NE(sun[0].find("emitters of type constant or envmap, and of type area in shapes"), std::string::npos);
}

TEST_F(ImportMitsubaTest, WhatIsNoXmlIsOneLine) {
    EXPECT_EQ(Mitsuba("<scene>\n<shape\n").problems().size(), 1u);
    EXPECT_EQ(Mitsuba("<mesh/>").problems(),
              Lines{"f:1: found <mesh>, allowed: <scene version=\"3.0.0\"> about all else"});
    EXPECT_TRUE(is_like_mitsuba("\n <?xml version=\"1.0\"?>"));
    EXPECT_FALSE(is_like_mitsuba("MATERIAL 0"));
    EXPECT_STREQ(import_format_of({.text = "", .file = "a/B.XML", .out = "", .name = ""}).name, "Mitsuba 3 XML");
}

TEST(MitsubaNumbersTest, CommasAndSpacesAreBetweenThem) {
    EXPECT_EQ(mitsuba_numbers(" 1, -2.5\t+3e2,"), (std::vector<double>{1, -2.5, 300}));
    EXPECT_FALSE(mitsuba_numbers("1 x").has_value());
    EXPECT_FALSE(mitsuba_numbers("inf").has_value());
    EXPECT_EQ(mitsuba_index_of("BK7"), 1.5046);
}

}  // namespace
}  // namespace pt::test
