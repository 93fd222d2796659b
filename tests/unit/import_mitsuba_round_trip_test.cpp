// What `ptbench export --format mitsuba` wrote of a shipped scene is imported as the scene that it was: every number to
// the last bit, and so every bit of the film.
#include <algorithm>
#include <filesystem>

#include <gtest/gtest.h>

#include "harness/exr.h"
#include "harness/interchange/export_mitsuba.h"
#include "harness/interchange/import_mitsuba.h"
#include "harness/interchange/mitsuba_limits.h"
#include "harness/interchange/xml_document.h"
#include "harness/mesh/write_mesh.h"
#include "harness/scene/scene_mesh.h"
#include "tests/support/command.h"
#include "tests/support/places.h"
#include "tests/support/render.h"
#include "tests/support/scenes.h"

namespace pt::test {
namespace {

bool is_expressible(const Scene& scene) { return mitsuba_problems(scene, "", scene.max_depth).empty(); }

// The shipped scenes that Mitsuba can express; of those with meshes, one of each kind that is quick to read.
std::vector<std::string> scenes_to_export() {
    std::vector<std::string> names{"scenes/meshes/menger_room.json", "scenes/meshes/sphereflake_room.json"};
    const std::filesystem::path source(test::source_folder());
    for (const auto& entry : std::filesystem::directory_iterator(source / "scenes")) {
        if (entry.path().extension() == ".json" && is_expressible(load_scene(entry.path().string()))) {
            names.push_back(entry.path().lexically_relative(source).string());
        }
    }
    std::sort(names.begin(), names.end());
    return names;
}

struct ThereAndBack {
    // Exported into the folder and imported from it.
    Scene there_and_back(const Scene& scene) {
        const MitsubaScene exported = mitsuba_scene(scene,
                                                    {.width = scene.camera.width,
                                                     .height = scene.camera.height,
                                                     .depth = scene.max_depth,
                                                     .samples = 64,
                                                     .scale = 1},
                                                    folder.file("there.xml"));
        exported.files.write(exported.xml);
        result = import_mitsuba({.text = exported.xml,
                                 .file = folder.file("there.xml"),
                                 .out = folder.file("back.json"),
                                 .name = scene.name});
        for (const std::string& problem : result.problems.messages("there.xml", "")) {
            ADD_FAILURE() << problem;
        }
        return result.json.empty() ? Scene() : parse_scene(result.json, folder.file("back.json"));
    }

    TemporaryFolder folder;
    ImportResult result;
};

class MitsubaRoundTripTest : public testing::TestWithParam<std::string>, protected ThereAndBack {};

// Columns of the matrix that places it.
std::vector<Vec3d> placement(const SceneObject& object) {
    const Rotation rotation = rotation_of(object.rotate_degrees);
    const bool is_round = object.shape == Shape::sphere;  // however it is turned
    std::vector<Vec3d> columns{object.translate};
    for (int i = 0; i < 3; ++i) {
        columns.push_back((is_round ? Vec3d(0.0) : rotation.column[i]) * object.scale[i]);
    }
    columns.push_back(is_round ? object.scale : Vec3d(0.0));
    return columns;
}

void expect_same_material(const SceneMaterial& was, const SceneMaterial& is) {
    // A mix whose mirror has the probability 0 or 1 is one of its parts.
    const bool is_part = was.type == MaterialType::mix;
    EXPECT_TRUE(is.type == was.type || is_part) << was.name;
    if (!is_part || was.mirror_probability == 0) {
        EXPECT_EQ(is.albedo, was.albedo) << was.name;
    }
    if (!is_part || was.mirror_probability == 1) {
        EXPECT_EQ(is.reflectance, was.reflectance) << was.name;
    }
    EXPECT_EQ(is.emission, was.emission) << was.name;
    EXPECT_EQ(is.tint, was.tint) << was.name;
    EXPECT_EQ(is.sigma_a, was.sigma_a) << was.name;
    EXPECT_EQ(is.ior, was.ior) << was.name;
}

TEST_P(MitsubaRoundTripTest, EveryNumberComesBack) {
    if (!reads_xml()) {
        GTEST_SKIP() << "this build has no reader for XML";
    }
    const Scene scene = load_scene(test::in_source(GetParam()));
    const Scene back = there_and_back(scene);
    EXPECT_EQ(result.warnings.messages("there.xml", ""), std::vector<std::string>());
    EXPECT_EQ(back.name, scene.name);
    EXPECT_EQ(back.max_depth, scene.max_depth);
    EXPECT_EQ(back.environment, scene.environment);
    EXPECT_EQ(back.camera.eye, scene.camera.eye);
    EXPECT_EQ(back.camera.look_at, scene.camera.look_at);
    EXPECT_EQ(back.camera.up, scene.camera.up);
    EXPECT_EQ(back.camera.vertical_fov_degrees, scene.camera.vertical_fov_degrees);
    EXPECT_EQ(back.camera.aperture_radius, scene.camera.aperture_radius);
    if (scene.camera.aperture_radius > 0) {
        EXPECT_EQ(back.camera.focus_distance, scene.camera.focus_distance);
    }
    EXPECT_EQ(back.camera.width, scene.camera.width);
    EXPECT_EQ(back.camera.height, scene.camera.height);
    ASSERT_EQ(back.objects.size(), scene.objects.size());
    for (std::size_t i = 0; i < scene.objects.size() && !HasFailure(); ++i) {
        const SceneObject &was = scene.objects[i], &is = back.objects[i];
        EXPECT_EQ(name_of(is.shape), name_of(was.shape));
        SceneObject standing = was;
        standing.translate = place_of(scene, was);
        EXPECT_EQ(placement(is), placement(standing)) << i;
        expect_same_material(scene.materials[was.material], back.materials[is.material]);
        ASSERT_EQ(is.mesh == SceneObject::no_mesh, was.mesh == SceneObject::no_mesh);
        if (was.mesh != SceneObject::no_mesh) {
            EXPECT_EQ(back.meshes[is.mesh]->hash, scene.meshes[was.mesh]->hash);
        }
    }
}

TEST_P(MitsubaRoundTripTest, EveryBitOfTheFilmComesBack) {
    if (!reads_xml()) {
        GTEST_SKIP() << "this build has no reader for XML";
    }
    Scene scene = load_scene(test::in_source(GetParam()));
    Scene back = there_and_back(scene);
    scene.camera.width = scene.camera.height = back.camera.width = back.camera.height = 12;
    const RenderOptions options{.samples = 2};
    const std::string accelerator = scene.meshes.empty() ? "" : "accelerator";
    EXPECT_EQ(render_variant(back, options, accelerator, "bvh2").hash(),
              render_variant(scene, options, accelerator, "bvh2").hash());
}

INSTANTIATE_TEST_SUITE_P(Shipped, MitsubaRoundTripTest, testing::ValuesIn(scenes_to_export()), [](const auto& scene) {
    std::string name = scene.param;
    std::replace_if(
        name.begin(), name.end(), [](char c) { return c == '/' || c == '.' || c == '-'; }, '_');
    return name;
});

// One of each that can show an image, each turned about all axes, and a mesh that two objects show.
std::string scene_with_images() {
    const std::string image = "{\"image\": \"" + test::in_source("scenes/textures/tiles.png") + "\"}";
    const std::string mesh =
        R"("vertices": [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0.3]], "triangles": [[0, 1, 2], [0, 2, 3]],
        "texture_coordinates": [[0.1, 0.2], [1.7, 0], [2, 1], [0, 3]], "material": "tiles", "rotate_degrees": [10, 20, 30])";
    return R"({"name": "images", "max_depth": 5, "environment": [1, 0.5, 0.25],
  "camera": {"eye": [0, 1, 6], "look_at": [0, 0, 0], "up": [0, 1, 0], "vertical_fov_degrees": 60, "resolution": [24, 24]},
  "materials": {"tiles": {"type": "diffuse", "albedo": )" +
           image + R"(}, "mirror": {"type": "mirror", "reflectance": )" + image + R"(},
    "part": {"type": "mix", "albedo": )" +
           image + R"(, "reflectance": [1, 1, 1], "mirror_probability": 0}},
  "objects": [
    {"shape": "quad", "material": "tiles", "translate": [-1, 0, 0], "rotate_degrees": [70, 15, -5], "scale": [3, 1, 2]},
    {"shape": "quad", "material": "part", "translate": [0, -1, 0], "scale": [6, 1, 6]},
    {"shape": "sphere", "material": "tiles", "translate": [1.5, 0, 1], "rotate_degrees": [25, -40, 110], "scale": 1.5},
    {"shape": "sphere", "material": "mirror", "translate": [-1.5, 0, 2], "scale": 1},
    {"shape": "mesh", "translate": [-2, 0.5, 1], )" +
           mesh + R"(}, {"shape": "mesh", "translate": [1, 1, 0], )" + mesh + "}]}";
}

TEST(MitsubaImagesTest, EveryBitOfTheFilmComesBack) {
    if (!reads_xml()) {
        GTEST_SKIP() << "this build has no reader for XML";
    }
    const Scene scene = parse_scene(scene_with_images(), "scene.json");
    ASSERT_EQ(mitsuba_problems(scene, "scene.json", scene.max_depth), std::vector<std::string>());
    ThereAndBack way;
    const Scene back = way.there_and_back(scene);
    EXPECT_EQ(way.result.warnings.messages("f", ""), std::vector<std::string>());
    ASSERT_EQ(back.objects.size(), scene.objects.size());
    EXPECT_TRUE(way.result.meshes.empty());  // those that the export wrote are good as they are
    const RenderOptions options{.samples = 4};
    EXPECT_EQ(render_variant(back, options, "accelerator", "bvh2").hash(),
              render_variant(scene, options, "accelerator", "bvh2").hash());
}

// Mitsuba's own coordinates have the image's corners where ours have them: u from its first column on, v from its first
// row on. Those of a rectangle are (x + 1) / 2 and (y + 1) / 2, those of a sphere atan2(y, x) / 2 pi and acos(z) / pi,
// and those of a PLY with flip_tex_coords u and 1 - v of the file (src/shapes/ of Mitsuba 3).
TEST(MitsubaImagesTest, CoordinatesAreTurnedByTheirFormulas) {
    const Scene scene = parse_scene(scene_with_images(), "scene.json");
    const MitsubaScene exported = mitsuba_scene(scene, {.width = 24, .height = 24, .depth = 5}, "there");
    EXPECT_EQ(exported.images, 1u);
    EXPECT_TRUE(exported.files.contents().contains("there_image_0.png"));
    const auto has = [&](const std::string& text) { return exported.xml.find(text) != std::string::npos; };
    // The floor, upright for who looks down with -z ahead: its y goes with +z, so that the first row is at -z.
    EXPECT_TRUE(has("<matrix value=\"3 0 0 0 0 0 -0.5 -1 0 3 0 0 0 0 0 1\"/>")) << exported.xml;
    // The ball that is not turned: its z is +y, and the middle of the image, at -x there, is +z; a quarter further on,
    // at -y there, is +x.
    EXPECT_TRUE(has("<matrix value=\"0 -0.5 0 -1.5 0 0 0.5 0 -0.5 0 0 2 0 0 0 1\"/>")) << exported.xml;
    EXPECT_TRUE(has("<boolean name=\"flip_tex_coords\" value=\"true\"/>"));
    EXPECT_TRUE(has(R"(<texture type="bitmap" name="reflectance">
        <string name="filename" value="there_image_0.png"/>
        <string name="filter_type" value="bilinear"/>
        <string name="wrap_mode" value="repeat"/>
        <boolean name="raw" value="false"/>
        <string name="format" value="variant"/>
      </texture>)"))
        << exported.xml;
    EXPECT_TRUE(has("<texture type=\"bitmap\" name=\"specular_reflectance\">"));
    const Mesh file = indexed_mesh(*scene.meshes[0]);
    ASSERT_EQ(file.coordinates.size(), 2u);
    for (std::size_t i = 0; i < 2; ++i) {
        for (std::size_t corner = 0; corner < 3; ++corner) {
            const CornerCoordinates& here = scene.meshes[0]->coordinates[i];
            EXPECT_EQ(file.coordinates[i][corner], (std::array<float, 2>{here.u[corner], here.v[corner]}));
        }
    }
}

// An environment's image has many more texels in the exported file, for Mitsuba blends them; they lie where they lay.
TEST(MitsubaEnvironmentTest, ComesBack) {
    if (!reads_xml() || !has_openexr()) {
        GTEST_SKIP() << "this build has no reader for XML, or no OpenEXR";
    }
    SceneBuilder builder;
    builder.sphere(builder.diffuse(Vec3d(0.5)), {0, 3, 0}, 1);
    builder.environment_map(
        4, 2, {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}, {2, 3, 1}, {0, 1, 0}, {1, 0, 0}, {9, 9, 9}, {5, 5, 5}}, -37.5);
    Scene scene = builder.scene;
    auto named = std::make_shared<SceneEnvironment>(*scene.environment_map);
    named->file = "sky.hdr";
    scene.environment_map = named;
    const TemporaryFolder folder;
    const MitsubaScene exported =
        mitsuba_scene(scene, {.width = 16, .height = 16, .depth = 3}, folder.file("there.xml"));
    ASSERT_TRUE(exported.files.contents().contains("there_environment.exr"));
    exported.files.write(exported.xml);
    const ImportResult result = import_mitsuba(
        {.text = exported.xml, .file = folder.file("there.xml"), .out = folder.file("back.json"), .name = "back"});
    EXPECT_EQ(result.problems.messages("f", ""), std::vector<std::string>());
    EXPECT_EQ(result.warnings.count(), 1u);  // Mitsuba's blending
    const Scene back = parse_scene(result.json, folder.file("back.json"));
    ASSERT_NE(back.environment_map, nullptr);
    EXPECT_EQ(back.environment_map->rotation_degrees, -37.5);
    const EnvironmentImage& image = back.environment_map->image;
    ASSERT_EQ(image.width, 4u * 32);
    ASSERT_EQ(image.height, 2u * 32 + 1);
    for (std::uint32_t y = 0; y < image.height; ++y) {
        for (std::uint32_t x = 0; x < image.width; ++x) {
            const auto& texels = named->image.texels;
            const Vec3<float> upper = texels[x / 32], lower = texels[4 + x / 32];
            const Vec3<float> expected = y < 32 ? upper : y > 32 ? lower : (upper + lower) * 0.5f;
            ASSERT_EQ(image.texels[y * image.width + x], expected) << x << ", " << y;
        }
    }
}

TEST(MitsubaEnvironmentTest, OfOneNumberIsConstant) {
    SceneBuilder builder;
    builder.sphere(builder.diffuse(Vec3d(0.5)), {0, 3, 0}, 1);
    builder.environment_map(1, 1, {{1, 0.5, 2}});
    const MitsubaScene exported = mitsuba_scene(builder.scene, {.width = 16, .height = 16, .depth = 3}, "there");
    EXPECT_TRUE(exported.files.contents().empty());
    EXPECT_NE(exported.xml.find("<emitter type=\"constant\">\n    <rgb name=\"radiance\" value=\"1, 0.5, 2\"/>"),
              std::string::npos)
        << exported.xml;
}

TEST(MitsubaRoundTripScenesTest, ThereAreManyScenes) { EXPECT_GE(scenes_to_export().size(), 20u); }

}  // namespace
}  // namespace pt::test
