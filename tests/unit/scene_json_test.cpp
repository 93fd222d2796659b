// Scene files: every default, every range, and every message that a wrong file ends in.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "harness/failure.h"
#include "harness/scene/scene.h"
#include "tests/support/command.h"
#include "tests/support/places.h"

namespace pt {
namespace {

// Each line is there to be replaced by the tests.
const std::string good = R"({
  "name": "good",
  "max_depth": 4,
  "camera": {
    "eye": [0, 1, 5],
    "look_at": [0, 1, 0],
    "up": [0, 1, 0],
    "vertical_fov_degrees": 40,
    "resolution": [8, 6]
  },
  "materials": {
    "m": {"type": "diffuse", "albedo": [0.5, 0.25, 1]}
  },
  "objects": [
    {"shape": "sphere", "material": "m"}
  ]
})";

const std::string material_line = R"({"type": "diffuse", "albedo": [0.5, 0.25, 1]})";
const std::string object_line = R"({"shape": "sphere", "material": "m"})";
const std::string resolution_line = R"("resolution": [8, 6])";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
    const std::size_t position = text.find(from);
    EXPECT_NE(position, std::string::npos) << from;
    return position == std::string::npos ? text : text.replace(position, from.size(), to);
}

Scene parse(const std::string& text) { return parse_scene(text, "s.json"); }

SceneMaterial parse_material(const std::string& material) {
    return parse(replaced(good, material_line, material)).materials.at(0);
}

SceneObject parse_object(const std::string& object) { return parse(replaced(good, object_line, object)).objects.at(0); }

SceneCamera parse_camera(const std::string& more) {
    return parse(replaced(good, resolution_line, resolution_line + ", " + more)).camera;
}

// The message of the error that parsing the text ends in; empty: none.
std::string error_of(const std::string& text) {
    try {
        parse(text);
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

TEST(SceneJson, SceneDefaults) {
    const Scene scene = parse(good);
    EXPECT_EQ(scene.name, "good");
    EXPECT_EQ(scene.description, "");
    EXPECT_EQ(scene.max_depth, 4u);
    EXPECT_EQ(scene.environment, Vec3d(0.0));
    EXPECT_EQ(scene.materials.size(), 1u);
    EXPECT_EQ(scene.objects.size(), 1u);
}

TEST(SceneJson, EnvironmentsThatAreDrawn) {
    const std::string folder = test::in_source("scenes/environments/");
    const auto with = [&](const std::string& environment) {
        return parse_scene(replaced(good, "\"max_depth\": 4", "\"max_depth\": 4, \"environment\": " + environment),
                           folder + "s.json");
    };
    const Scene even = with("{\"radiance\": [1, 2, 3]}");
    ASSERT_NE(even.environment_map, nullptr);
    EXPECT_EQ(even.environment, Vec3d(0.0));
    EXPECT_EQ(even.environment_map->image.texels, std::vector<Vec3<float>>{Vec3<float>(1, 2, 3)});
    EXPECT_TRUE(contains(features_of(even), Feature::environment_map));
    EXPECT_FALSE(contains(features_of(even), Feature::environment));
    const Scene sky = with("{\"file\": \"sky.hdr\"}");
    EXPECT_EQ(sky.environment_map->image.width, 64u);
    EXPECT_EQ(sky.environment_map->image.height, 32u);
    EXPECT_EQ(sky.environment_map->rotation_degrees, 0);
    const Scene turned = with("{\"file\": \"sky.hdr\", \"scale\": 2, \"rotation\": -30}");
    EXPECT_EQ(turned.environment_map->rotation_degrees, -30);
    for (std::size_t i = 0; i < sky.environment_map->image.texels.size(); ++i) {
        EXPECT_EQ(turned.environment_map->image.texels[i], sky.environment_map->image.texels[i] * 2.0f);
    }
    EXPECT_NE(turned.environment_map->hash, sky.environment_map->hash);  // which is part of the scene's
}

// Texels in rows of another length are another picture.
TEST(SceneJson, AnEnvironmentsShapeIsPartOfItsHash) {
    const test::TemporaryFolder folder;
    const auto hash_of = [&](int width, int height) {
        const std::string size = "-Y " + std::to_string(height) + " +X " + std::to_string(width) + "\n";
        std::string texels;
        for (char i = 10; i < 18; ++i) {
            texels += {i, 20, 30, char(-127)};
        }
        test::write_text(folder.file("sky.hdr"), "#?RADIANCE\n\n" + size + texels);
        return parse_scene(replaced(good, "\"max_depth\": 4", R"("max_depth": 4, "environment": {"file": "sky.hdr"})"),
                           folder.file("s.json"))
            .hash;
    };
    EXPECT_NE(hash_of(4, 2), hash_of(2, 4));
    EXPECT_NE(hash_of(8, 1), hash_of(2, 4));
    EXPECT_EQ(hash_of(8, 1), hash_of(8, 1));
}

TEST(SceneJson, CameraDefaults) {
    const SceneCamera camera = parse(good).camera;
    EXPECT_EQ(camera.eye, Vec3d(0, 1, 5));
    EXPECT_EQ(camera.look_at, Vec3d(0, 1, 0));
    EXPECT_EQ(camera.up, Vec3d(0, 1, 0));
    EXPECT_EQ(camera.vertical_fov_degrees, 40);
    EXPECT_EQ(camera.width, 8u);
    EXPECT_EQ(camera.height, 6u);
    EXPECT_TRUE(camera.jitter);
    EXPECT_EQ(camera.aperture_radius, 0);
    EXPECT_EQ(camera.focus_distance, 1);
    EXPECT_EQ(camera.shutter_open, 0);
    EXPECT_EQ(camera.shutter_close, 0);
    EXPECT_FALSE(camera.shutter_late);
}

TEST(SceneJson, ShutterDefaults) {
    const SceneCamera empty = parse_camera(R"("shutter": {})");
    EXPECT_EQ(empty.shutter_open, 0);
    EXPECT_EQ(empty.shutter_close, 0);
    EXPECT_FALSE(empty.shutter_late);
    const SceneCamera only_open = parse_camera(R"("shutter": {"open": 2})");
    EXPECT_EQ(only_open.shutter_open, 2);
    EXPECT_EQ(only_open.shutter_close, 2);
    const SceneCamera whole = parse_camera(R"("shutter": {"open": -1, "close": 0.5, "density": "late"})");
    EXPECT_EQ(whole.shutter_open, -1);
    EXPECT_EQ(whole.shutter_close, 0.5);
    EXPECT_TRUE(whole.shutter_late);
    EXPECT_FALSE(parse_camera(R"("shutter": {"close": 1, "density": "uniform"})").shutter_late);
}

TEST(SceneJson, CameraOptionsAreRead) {
    EXPECT_FALSE(parse_camera(R"("jitter": false)").jitter);
    EXPECT_EQ(parse_camera(R"("aperture_radius": 0.25)").aperture_radius, 0.25);
    EXPECT_EQ(parse_camera(R"("focus_distance": 7)").focus_distance, 7);
}

TEST(SceneJson, DiffuseDefaults) {
    const SceneMaterial material = parse_material(material_line);
    EXPECT_EQ(material.name, "m");
    EXPECT_EQ(material.type, MaterialType::diffuse);
    EXPECT_EQ(material.albedo, Vec3d(0.5, 0.25, 1));
    EXPECT_EQ(material.emission, Vec3d(0.0));
    EXPECT_EQ(parse_material(R"({"type": "diffuse", "albedo": [0, 0, 0], "emission": [1, 2, 3]})").emission,
              Vec3d(1, 2, 3));
}

TEST(SceneJson, Emitter) {
    const SceneMaterial material = parse_material(R"({"type": "emitter", "radiance": [1, 2, 1e30]})");
    EXPECT_EQ(material.type, MaterialType::emitter);
    EXPECT_EQ(material.emission, Vec3d(1, 2, 1e30));
    EXPECT_EQ(material.albedo, Vec3d(0.0));
}

TEST(SceneJson, RoughConductor) {
    const SceneMaterial material =
        parse_material(R"({"type": "rough_conductor", "reflectance": [0, 0.5, 1], "roughness": 0.3})");
    EXPECT_EQ(material.type, MaterialType::rough_conductor);
    EXPECT_EQ(material.reflectance, Vec3d(0, 0.5, 1));
    EXPECT_EQ(material.roughness, 0.3);
    EXPECT_FALSE(material.multiple_scattering);
    EXPECT_EQ(material.emission, Vec3d(0.0));
    EXPECT_TRUE(parse_material(R"({"type": "rough_conductor", "reflectance": [0, 0.5, 1], "roughness": 0.3,
                                   "multiple_scattering": true})")
                    .multiple_scattering);
}

TEST(SceneJson, RoughDielectric) {
    const SceneMaterial defaults = parse_material(R"({"type": "rough_dielectric", "ior": 1.5, "roughness": 0.3})");
    EXPECT_EQ(defaults.type, MaterialType::rough_dielectric);
    EXPECT_EQ(defaults.ior, 1.5);
    EXPECT_EQ(defaults.roughness, 0.3);
    EXPECT_EQ(defaults.tint, Vec3d(1.0));
    EXPECT_EQ(defaults.sigma_a, Vec3d(0.0));
    const SceneMaterial full = parse_material(
        R"({"type": "rough_dielectric", "ior": 2, "roughness": 1, "tint": [1, 0.5, 0], "sigma_a": [1, 2, 3]})");
    EXPECT_EQ(full.tint, Vec3d(1, 0.5, 0));
    EXPECT_EQ(full.sigma_a, Vec3d(1, 2, 3));
}

TEST(SceneJson, Principled) {
    const SceneMaterial defaults =
        parse_material(R"({"type": "principled", "base_colour": [0, 0.5, 1], "roughness": 0.3})");
    EXPECT_EQ(defaults.type, MaterialType::principled);
    EXPECT_EQ(defaults.albedo, Vec3d(0, 0.5, 1));
    EXPECT_EQ(defaults.roughness, 0.3);
    EXPECT_EQ(defaults.metallic, 0);
    EXPECT_EQ(defaults.transmission, 0);
    EXPECT_EQ(defaults.ior, 1.5);
    EXPECT_EQ(defaults.emission, Vec3d(0.0));
    const SceneMaterial full = parse_material(
        R"({"type": "principled", "base_colour": [1, 1, 1], "roughness": 1, "metallic": 1, "transmission": 0.25,
            "ior": 2, "emission": [1, 2, 3]})");
    EXPECT_EQ(full.metallic, 1);
    EXPECT_EQ(full.transmission, 0.25);
    EXPECT_EQ(full.ior, 2);
    EXPECT_EQ(full.emission, Vec3d(1, 2, 3));
}

TEST(SceneJson, MirrorDefaults) {
    const SceneMaterial material = parse_material(R"({"type": "mirror", "reflectance": [0, 0.5, 1]})");
    EXPECT_EQ(material.type, MaterialType::mirror);
    EXPECT_EQ(material.reflectance, Vec3d(0, 0.5, 1));
    EXPECT_EQ(material.emission, Vec3d(0.0));
}

TEST(SceneJson, MixDefaults) {
    const SceneMaterial material = parse_material(
        R"({"type": "mix", "albedo": [0.1, 0.2, 0.3], "reflectance": [0.4, 0.5, 0.6], "mirror_probability": 0.7})");
    EXPECT_EQ(material.type, MaterialType::mix);
    EXPECT_EQ(material.albedo, Vec3d(0.1, 0.2, 0.3));
    EXPECT_EQ(material.reflectance, Vec3d(0.4, 0.5, 0.6));
    EXPECT_EQ(material.mirror_probability, 0.7);
    EXPECT_EQ(material.emission, Vec3d(0.0));
}

TEST(SceneJson, DielectricDefaults) {
    const SceneMaterial material = parse_material(R"({"type": "dielectric", "ior": 1.5})");
    EXPECT_EQ(material.type, MaterialType::dielectric);
    EXPECT_EQ(material.ior, 1.5);
    EXPECT_EQ(material.tint, Vec3d(1.0));
    EXPECT_EQ(material.sigma_a, Vec3d(0.0));
}

TEST(SceneJson, SubsurfaceDefaults) {
    const SceneMaterial material = parse_material(R"({"type": "subsurface", "sigma_s": [1, 2, 3]})");
    EXPECT_EQ(material.type, MaterialType::subsurface);
    EXPECT_EQ(material.ior, 1);
    EXPECT_EQ(material.sigma_a, Vec3d(0.0));
    EXPECT_EQ(material.sigma_s, Vec3d(1, 2, 3));
    EXPECT_EQ(material.g, 0);
    EXPECT_EQ(material.max_scatterings, 1000000u);
}

TEST(SceneJson, ObjectDefaults) {
    const SceneObject object = parse_object(object_line);
    EXPECT_EQ(object.shape, Shape::sphere);
    EXPECT_EQ(object.material, 0u);
    EXPECT_EQ(object.translate, Vec3d(0.0));
    EXPECT_EQ(object.rotate_degrees, Vec3d(0.0));
    EXPECT_EQ(object.scale, Vec3d(1.0));
    EXPECT_EQ(object.velocity, Vec3d(0.0));
}

TEST(SceneJson, ObjectOptionsAreRead) {
    const SceneObject object =
        parse_object(R"({"shape": "box", "material": "m", "translate": [1, 2, 3], "rotate_degrees": [4, 5, 6], )"
                     R"("scale": [7, 8, 9], "velocity": [-1, 0, 1]})");
    EXPECT_EQ(object.shape, Shape::box);
    EXPECT_EQ(object.translate, Vec3d(1, 2, 3));
    EXPECT_EQ(object.rotate_degrees, Vec3d(4, 5, 6));
    EXPECT_EQ(object.scale, Vec3d(7, 8, 9));
    EXPECT_EQ(object.velocity, Vec3d(-1, 0, 1));
    EXPECT_EQ(parse_object(R"({"shape": "quad", "material": "m", "scale": 2.5})").scale, Vec3d(2.5));
}

TEST(SceneJson, EndsOfRangesAreAllowed) {
    EXPECT_EQ(parse(replaced(good, "40", "179.999")).camera.vertical_fov_degrees, 179.999);
    EXPECT_EQ(parse(replaced(good, "[8, 6]", "[65536, 1024]")).camera.width, 65536u);
    EXPECT_EQ(parse(replaced(good, "\"max_depth\": 4", "\"max_depth\": 1000000")).max_depth, 1000000u);
    EXPECT_EQ(parse_object(R"({"shape": "sphere", "material": "m", "scale": 1e-18})").scale, Vec3d(1e-18));
    EXPECT_EQ(parse_material(R"({"type": "subsurface", "sigma_s": [0, 0, 0], "g": -0.9999, "max_scatterings": 1})").g,
              -0.9999);
    EXPECT_EQ(parse(replaced(good, object_line, "")).objects.size(), 0u);
}

TEST(SceneJson, HashIsThatOfTheContent) {
    const std::string hash = parse(good).hash;
    EXPECT_EQ(hash.size(), 16u);
    EXPECT_EQ(
        parse(replaced(good, "\"name\": \"good\",\n  \"max_depth\": 4,", "\"max_depth\":4,   \"name\":\"good\",")).hash,
        hash);
    EXPECT_NE(parse(replaced(good, "0.25", "0.26")).hash, hash);
}

struct BadScene {
    std::string from, to;  // what is replaced in the good text
    std::string message;
};

// Every case through one loop, so that adding one is adding a line.
void expect_messages(const std::vector<BadScene>& cases) {
    for (const BadScene& bad : cases) {
        EXPECT_EQ(error_of(replaced(good, bad.from, bad.to)), bad.message) << bad.from << " -> " << bad.to;
    }
}

TEST(SceneJsonErrors, Syntax) {
    expect_messages({
        {good, "[]", "s.json: $: found [], allowed: an object"},
        {good, "3", "s.json: $: found 3, allowed: an object"},
        {"0.25", "NaN",
         "s.json: not valid JSON: parse error at line 12, column 46: syntax error while parsing value - invalid "
         "literal; last read: '0.5, N'"},
        {"0.25", "Infinity",
         "s.json: not valid JSON: parse error at line 12, column 46: syntax error while parsing value - invalid "
         "literal; last read: '0.5, I'"},
        {"0.25", "1e999", "s.json: not valid JSON: number overflow parsing '1e999'"},
        {"0.25", "-1e999", "s.json: not valid JSON: number overflow parsing '-1e999'"},
        {"0.25", ".25",
         "s.json: not valid JSON: parse error at line 12, column 46: syntax error while parsing value - invalid "
         "literal; last read: '0.5, .'"},
        {"\"max_depth\": 4,", "// four\n",
         "s.json: not valid JSON: parse error at line 3, column 3: syntax error while parsing object key - invalid "
         "literal; last "
         "read: '\"good\",<U+000A>  /'; expected string literal"},
        {"\"max_depth\": 4,", "\"max_depth\": 4, \"max_depth\": 5,",
         "s.json: $: found the key \"max_depth\" twice, allowed: once"},
        {"\"up\"", "\"eye\": [0, 0, 0], \"up\"", "s.json: $.camera: found the key \"eye\" twice, allowed: once"},
        {"\"material\": \"m\"}", "\"material\": \"m\"}, {\"scale\": 1, \"scale\": 2}",
         "s.json: $.objects[1]: found the key \"scale\" twice, allowed: once"},
        {"\"m\": {", "\"m\": {\"type\": \"mirror\", \"reflectance\": [1, 1, 1]}, \"m\": {",
         "s.json: $.materials: found the key \"m\" twice, allowed: once"},
    });
}

TEST(SceneJsonErrors, Scene) {
    const std::string scene_keys = "name, description, max_depth, environment, camera, materials, objects";
    const std::string name_allowed = "1 to 64 letters, digits, '_' and '-' (it becomes part of benchmark names)";
    const std::string depth_allowed = "a whole number from 1 to 1000000";
    expect_messages({
        {"\"max_depth\"", "\"depth\"", "s.json: $: found unknown key \"depth\", allowed: " + scene_keys},
        {"\"name\": \"good\",", "", "s.json: $: found no key \"name\", allowed: it is required"},
        {"\"max_depth\": 4,", "", "s.json: $: found no key \"max_depth\", allowed: it is required"},
        {"\"good\"", "7", "s.json: $.name: found 7, allowed: a string"},
        {"\"good\"", "\"\"", "s.json: $.name: found \"\", allowed: " + name_allowed},
        {"\"good\"", "\"a/b\"", "s.json: $.name: found \"a/b\", allowed: " + name_allowed},
        {"\"good\"", "\"" + std::string(65, 'x') + "\"",
         "s.json: $.name: found \"" + std::string(56, 'x') + "..., allowed: " + name_allowed},
        {"\"name\"", "\"description\": [1], \"name\"", "s.json: $.description: found [1], allowed: a string"},
        {"\"max_depth\": 4", "\"max_depth\": 0", "s.json: $.max_depth: found 0, allowed: " + depth_allowed},
        {"\"max_depth\": 4", "\"max_depth\": -1", "s.json: $.max_depth: found -1, allowed: " + depth_allowed},
        {"\"max_depth\": 4", "\"max_depth\": 4.0", "s.json: $.max_depth: found 4.0, allowed: " + depth_allowed},
        {"\"max_depth\": 4", "\"max_depth\": \"4\"", "s.json: $.max_depth: found \"4\", allowed: " + depth_allowed},
        {"\"max_depth\": 4", "\"max_depth\": 18446744073709551615",
         "s.json: $.max_depth: found 18446744073709551615, allowed: " + depth_allowed},
        {"\"max_depth\": 4", "\"max_depth\": 4, \"environment\": 1",
         "s.json: $.environment: found 1, allowed: an array of 3 numbers, {\"radiance\": [R, G, B]} or {\"file\": "
         "NAME, ..}"},
        {"\"max_depth\": 4", "\"max_depth\": 4, \"environment\": [0, -1, 0]",
         "s.json: $.environment[1]: found -1, allowed: a number from 0 to 1e30"},
        {"\"max_depth\": 4", "\"max_depth\": 4, \"environment\": {\"radiance\": [0, -1, 0]}",
         "s.json: $.environment.radiance[1]: found -1, allowed: a number from 0 to 1e30"},
        {"\"max_depth\": 4", "\"max_depth\": 4, \"environment\": {\"radiance\": [0, 1, 0], \"scale\": 2}",
         "s.json: $.environment: found unknown key \"scale\", allowed: radiance"},
        {"\"max_depth\": 4", "\"max_depth\": 4, \"environment\": {}",
         "s.json: $.environment: found an object, allowed: {\"radiance\": [R, G, B]} or {\"file\": NAME, ..}"},
        {"\"max_depth\": 4", "\"max_depth\": 4, \"environment\": {\"file\": \"sky.hdr\", \"scale\": -1}",
         "s.json: $.environment.scale: found -1, allowed: a number from 0 to 1e30"},
        {"\"max_depth\": 4", "\"max_depth\": 4, \"environment\": {\"file\": \"sky.png\"}",
         "sky.png: file name: found the ending \".png\", allowed: .hdr or .exr"},
        {"\"objects\": [", "\"objects\": {}, \"description\": [",
         "s.json: $.description: found an array of 1, allowed: a string"},
        {"[\n    " + object_line + "\n  ]", "{}", "s.json: $.objects: found an object, allowed: an array"},
        {"{\n    \"m\": " + material_line + "\n  }", "[]",
         "s.json: $.materials: found [], allowed: an object of named materials"},
    });
}

TEST(SceneJsonErrors, Camera) {
    const std::string camera_keys =
        "eye, look_at, up, vertical_fov_degrees, resolution, jitter, aperture_radius, focus_distance, shutter";
    const std::string up_allowed = "a direction that is not 0 and not parallel to look_at - eye";
    const std::string length_allowed = "a direction that is not 0: a vector of length 1e-18 or more";
    const std::string look_at_allowed = "a point other than camera.eye, at least 1e-18 away";
    const std::string side_allowed = "a whole number from 1 to 65536";
    const std::string fov_allowed = "an angle from 1e-6 to 179.999 degrees";
    const auto with = [&](const std::string& more) { return resolution_line + ", " + more; };
    expect_messages({
        {"\"up\"", "\"upwards\"", "s.json: $.camera: found unknown key \"upwards\", allowed: " + camera_keys},
        {"\"up\": [0, 1, 0],", "", "s.json: $.camera: found no key \"up\", allowed: it is required"},
        {"[0, 1, 5]", "[0, 1]", "s.json: $.camera.eye: found [0,1], allowed: an array of 3 numbers"},
        {"[0, 1, 5]", "[0, 1, 5, 1]", "s.json: $.camera.eye: found [0,1,5,1], allowed: an array of 3 numbers"},
        {"[0, 1, 5]", "[0, null, 5]", "s.json: $.camera.eye[1]: found null, allowed: a number from -1e18 to 1e18"},
        {"[0, 1, 5]", "[0, 1, 1e19]", "s.json: $.camera.eye[2]: found 1e+19, allowed: a number from -1e18 to 1e18"},
        {"\"look_at\": [0, 1, 0]", "\"look_at\": [0, 1, 5]",
         "s.json: $.camera.look_at: found [0,1,5], allowed: " + look_at_allowed},
        {"\"look_at\": [0, 1, 0]", "\"look_at\": [1e-19, 1, 5]",
         "s.json: $.camera.look_at: found [1e-19,1,5], allowed: " + look_at_allowed},
        {"\"up\": [0, 1, 0]", "\"up\": [0, 0, -2]", "s.json: $.camera.up: found [0,0,-2], allowed: " + up_allowed},
        {"\"up\": [0, 1, 0]", "\"up\": [0, 0, 0]", "s.json: $.camera.up: found [0,0,0], allowed: " + length_allowed},
        {"\"up\": [0, 1, 0]", "\"up\": [0, 1e-162, 0]",
         "s.json: $.camera.up: found [0,1e-162,0], allowed: " + length_allowed},
        {"40", "0", "s.json: $.camera.vertical_fov_degrees: found 0, allowed: " + fov_allowed},
        {"40", "180", "s.json: $.camera.vertical_fov_degrees: found 180, allowed: " + fov_allowed},
        {"40", "true", "s.json: $.camera.vertical_fov_degrees: found true, allowed: " + fov_allowed},
        {"[8, 6]", "[8]",
         "s.json: $.camera.resolution: found [8], allowed: an array of 2 whole numbers, [width, height]"},
        {"[8, 6]", "8", "s.json: $.camera.resolution: found 8, allowed: an array of 2 whole numbers, [width, height]"},
        {"[8, 6]", "[0, 6]", "s.json: $.camera.resolution[0]: found 0, allowed: " + side_allowed},
        {"[8, 6]", "[8, 6.5]", "s.json: $.camera.resolution[1]: found 6.5, allowed: " + side_allowed},
        {"[8, 6]", "[65537, 6]", "s.json: $.camera.resolution[0]: found 65537, allowed: " + side_allowed},
        {"[8, 6]", "[65536, 1025]", "s.json: $.camera.resolution: found [65536,1025], allowed: at most 2^26 pixels"},
        {resolution_line, with(R"("jitter": 1)"), "s.json: $.camera.jitter: found 1, allowed: true or false"},
        {resolution_line, with(R"("aperture_radius": -0.5)"),
         "s.json: $.camera.aperture_radius: found -0.5, allowed: a number from 0 to 1e18"},
        {resolution_line, with(R"("focus_distance": 0)"),
         "s.json: $.camera.focus_distance: found 0, allowed: a number from 1e-18 to 1e18"},
        {resolution_line, with(R"("shutter": 1)"), "s.json: $.camera.shutter: found 1, allowed: an object"},
        {resolution_line, with(R"("shutter": {"length": 1})"),
         "s.json: $.camera.shutter: found unknown key \"length\", allowed: open, close, density"},
        {resolution_line, with(R"("shutter": {"open": 2, "close": 1})"),
         "s.json: $.camera.shutter.close: found 1, allowed: no less than shutter.open, 2"},
        {resolution_line, with(R"("shutter": {"open": 1e10})"),
         "s.json: $.camera.shutter.open: found 10000000000.0, allowed: a time from -1e9 to 1e9 seconds"},
        {resolution_line, with(R"("shutter": {"density": "early"})"),
         R"(s.json: $.camera.shutter.density: found "early", allowed: "uniform", "late")"},
    });
}

TEST(SceneJsonErrors, Materials) {
    const std::string types =
        R"("diffuse", "emitter", "mirror", "mix", "dielectric", "rough_conductor", "rough_dielectric", "principled", )"
        R"("subsurface")";
    const std::string fraction = "a number from 0 to 1";
    const std::string sigma = "a number from 0 to 1e18";
    expect_messages({
        {material_line, "3", "s.json: $.materials.m: found 3, allowed: an object"},
        {material_line, R"({"albedo": [1, 1, 1]})",
         "s.json: $.materials.m: found no key \"type\", allowed: it is required: diffuse, emitter, mirror, mix, "
         "dielectric, rough_conductor, rough_dielectric, principled, subsurface"},
        {"\"diffuse\"", "\"glossy\"", R"(s.json: $.materials.m.type: found "glossy", allowed: )" + types},
        {"\"diffuse\"", "null", "s.json: $.materials.m.type: found null, allowed: " + types},
        {material_line, R"({"type": "diffuse"})",
         "s.json: $.materials.m: found no key \"albedo\", allowed: it is required"},
        {material_line, R"({"type": "diffuse", "albedo": [1, 1, 1], "ior": 1})",
         "s.json: $.materials.m: found unknown key \"ior\", allowed: type, albedo, emission, normal"},
        {"0.25", "1.25", "s.json: $.materials.m.albedo[1]: found 1.25, allowed: " + fraction},
        {"0.25", "-0.25", "s.json: $.materials.m.albedo[1]: found -0.25, allowed: " + fraction},
        {"0.25", "\"NaN\"", "s.json: $.materials.m.albedo[1]: found \"NaN\", allowed: " + fraction},
        {"[0.5, 0.25, 1]", "0.5",
         "s.json: $.materials.m.albedo: found 0.5, allowed: an array of 3 numbers, or {\"image\": NAME}"},
        {material_line, R"({"type": "diffuse", "albedo": [1, 1, 1], "emission": [0, 0, -1]})",
         "s.json: $.materials.m.emission[2]: found -1, allowed: a number from 0 to 1e30"},
        {material_line, R"({"type": "emitter", "radiance": [1, 1, 2e30]})",
         "s.json: $.materials.m.radiance[2]: found 2e+30, allowed: a number from 0 to 1e30"},
        {material_line, R"({"type": "emitter", "emission": [1, 1, 1]})",
         "s.json: $.materials.m: found unknown key \"emission\", allowed: type, radiance"},
        {material_line, R"({"type": "mirror", "albedo": [1, 1, 1]})",
         "s.json: $.materials.m: found unknown key \"albedo\", allowed: type, reflectance, emission, normal"},
        {material_line, R"({"type": "mirror", "reflectance": [1, 1, 1.5]})",
         "s.json: $.materials.m.reflectance[2]: found 1.5, allowed: " + fraction},
        {material_line, R"({"type": "mix", "albedo": [1, 1, 1], "reflectance": [1, 1, 1]})",
         "s.json: $.materials.m: found no key \"mirror_probability\", allowed: it is required"},
        {material_line, R"({"type": "mix", "albedo": [1, 1, 1], "reflectance": [1, 1, 1], "mirror_probability": 1.1})",
         "s.json: $.materials.m.mirror_probability: found 1.1, allowed: " + fraction},
        {material_line, R"({"type": "rough_conductor", "reflectance": [1, 1, 1]})",
         "s.json: $.materials.m: found no key \"roughness\", allowed: it is required"},
        {material_line, R"({"type": "rough_conductor", "reflectance": [1, 1, 1], "roughness": -0.1})",
         "s.json: $.materials.m.roughness: found -0.1, allowed: " + fraction},
        {material_line, R"({"type": "rough_conductor", "reflectance": [1, 1, 1], "roughness": 0.1, "alpha": 1})",
         "s.json: $.materials.m: found unknown key \"alpha\", allowed: type, reflectance, roughness, "
         "multiple_scattering, emission, normal"},
        {material_line, R"({"type": "rough_dielectric", "ior": 1.5})",
         "s.json: $.materials.m: found no key \"roughness\", allowed: it is required"},
        {material_line, R"({"type": "rough_dielectric", "ior": 1.5, "roughness": 2})",
         "s.json: $.materials.m.roughness: found 2, allowed: " + fraction},
        {material_line, R"({"type": "rough_dielectric", "ior": 1.5, "roughness": 0.1, "emission": [1, 1, 1]})",
         "s.json: $.materials.m: found unknown key \"emission\", allowed: type, ior, roughness, tint, sigma_a, normal"},
        {material_line, R"({"type": "principled", "roughness": 0.1})",
         "s.json: $.materials.m: found no key \"base_colour\", allowed: it is required"},
        {material_line, R"({"type": "principled", "base_colour": [1, 1, 1]})",
         "s.json: $.materials.m: found no key \"roughness\", allowed: it is required"},
        {material_line, R"({"type": "principled", "base_colour": [1, 2, 1], "roughness": 0.1})",
         "s.json: $.materials.m.base_colour[1]: found 2, allowed: " + fraction},
        {material_line, R"({"type": "principled", "base_colour": [1, 1, 1], "roughness": 0.1, "metallic": 1.5})",
         "s.json: $.materials.m.metallic: found 1.5, allowed: " + fraction},
        {material_line, R"({"type": "principled", "base_colour": [1, 1, 1], "roughness": 0.1, "transmission": -1})",
         "s.json: $.materials.m.transmission: found -1, allowed: " + fraction},
        {material_line, R"({"type": "principled", "base_colour": [1, 1, 1], "roughness": 0.1, "ior": 0.9})",
         "s.json: $.materials.m.ior: found 0.9, allowed: a number from 1 to 1e4"},
        {material_line, R"({"type": "principled", "base_colour": [1, 1, 1], "roughness": 0.1, "sheen": 1})",
         "s.json: $.materials.m: found unknown key \"sheen\", allowed: type, base_colour, metallic, roughness, "
         "transmission, ior, emission, normal"},
        {material_line, R"({"type": "principled", "base_colour": [1, 1, 1], "roughness": 0.1, "transmission": 0.5,
                            "emission": [1, 0, 0]})",
         "s.json: $.materials.m.emission: found [1,0,0], allowed: none, where light passes through: transmission 0 or "
         "metallic 1"},
        {material_line, R"({"type": "dielectric"})",
         "s.json: $.materials.m: found no key \"ior\", allowed: it is required"},
        {material_line, R"({"type": "dielectric", "ior": 0})",
         "s.json: $.materials.m.ior: found 0, allowed: a number from 0.01 to 1e4"},
        {material_line, R"({"type": "dielectric", "ior": [1.5, 1.5, 1.5]})",
         "s.json: $.materials.m.ior: found [1.5,1.5,1.5], allowed: a number from 0.01 to 1e4"},
        {material_line, R"({"type": "dielectric", "ior": 1.5, "tint": [1, 1, 2]})",
         "s.json: $.materials.m.tint[2]: found 2, allowed: " + fraction},
        {material_line, R"({"type": "dielectric", "ior": 1.5, "sigma_a": [-1, 0, 0]})",
         "s.json: $.materials.m.sigma_a[0]: found -1, allowed: " + sigma},
        {material_line, R"({"type": "dielectric", "ior": 1.5, "emission": [1, 1, 1]})",
         "s.json: $.materials.m: found unknown key \"emission\", allowed: type, ior, tint, sigma_a, normal"},
        {material_line, R"({"type": "subsurface", "sigma_a": [1, 1, 1]})",
         "s.json: $.materials.m: found no key \"sigma_s\", allowed: it is required"},
        {material_line, R"({"type": "subsurface", "sigma_s": [1, 1, -1]})",
         "s.json: $.materials.m.sigma_s[2]: found -1, allowed: " + sigma},
        {material_line, R"({"type": "subsurface", "sigma_s": [1, 1, 1], "g": 1})",
         "s.json: $.materials.m.g: found 1, allowed: a number from -0.9999 to 0.9999"},
        {material_line, R"({"type": "subsurface", "sigma_s": [1, 1, 1], "max_scatterings": 0})",
         "s.json: $.materials.m.max_scatterings: found 0, allowed: a whole number from 1 to 1000000000"},
        {material_line, R"({"type": "subsurface", "sigma_s": [1, 1, 1], "albedo": [1, 1, 1]})",
         "s.json: $.materials.m: found unknown key \"albedo\", allowed: type, ior, sigma_a, sigma_s, g, "
         "max_scatterings"},
    });
}

TEST(SceneJsonErrors, Objects) {
    const std::string scale = "a number from 1e-18 to 1e18";
    const std::string point = "a number from -1e18 to 1e18";
    const std::string glass = "\"m\": " + material_line;
    const auto sphere_with = [](const std::string& more) {
        return R"({"shape": "sphere", "material": "m", )" + more + "}";
    };
    expect_messages({
        {object_line, "[]", "s.json: $.objects[0]: found [], allowed: an object"},
        {object_line, R"({"material": "m"})", "s.json: $.objects[0]: found no key \"shape\", allowed: it is required"},
        {object_line, R"({"shape": "sphere"})",
         "s.json: $.objects[0]: found no key \"material\", allowed: it is required"},
        {"\"sphere\"", "\"cube\"",
         R"(s.json: $.objects[0].shape: found "cube", allowed: "sphere", "box", "quad", "mesh")"},
        {"\"material\": \"m\"", "\"material\": 0", "s.json: $.objects[0].material: found 0, allowed: a string"},
        {"\"material\": \"m\"", "\"material\": \"n\"",
         R"(s.json: $.objects[0].material: found "n", allowed: a name in $.materials: m)"},
        {object_line, sphere_with("\"radius\": 1"),
         "s.json: $.objects[0]: found unknown key \"radius\", allowed: shape, material, translate, rotate_degrees, "
         "scale, velocity"},
        {object_line, sphere_with("\"scale\": -1"),
         "s.json: $.objects[0].scale: found -1, allowed: " + scale + ", or an array of 3"},
        {object_line, sphere_with("\"scale\": 0"),
         "s.json: $.objects[0].scale: found 0, allowed: " + scale + ", or an array of 3"},
        {object_line, sphere_with("\"scale\": [1, -1, 1]"),
         "s.json: $.objects[0].scale[1]: found -1, allowed: " + scale},
        {object_line, sphere_with("\"scale\": [1, 1]"),
         "s.json: $.objects[0].scale: found [1,1], allowed: an array of 3 numbers"},
        {object_line, sphere_with("\"scale\": \"big\""),
         "s.json: $.objects[0].scale: found \"big\", allowed: " + scale + ", or an array of 3"},
        {object_line, sphere_with("\"translate\": 1"),
         "s.json: $.objects[0].translate: found 1, allowed: an array of 3 numbers"},
        {object_line, sphere_with("\"translate\": [[1], [2], [3]]"),
         "s.json: $.objects[0].translate[0]: found [1], allowed: " + point},
        {object_line, sphere_with("\"rotate_degrees\": [0, 0, 2e6]"),
         "s.json: $.objects[0].rotate_degrees[2]: found 2000000.0, allowed: an angle from -1e6 to 1e6 degrees"},
        {object_line, sphere_with("\"velocity\": [0, false, 0]"),
         "s.json: $.objects[0].velocity[1]: found false, allowed: " + point},
        {object_line, sphere_with("\"scale\": [1, 1e-6, 2e6]"),
         "s.json: $.objects[0].scale: found [1,1e-06,2000000.0], allowed: of a sphere, axes that differ by no more "
         "than "
         "a factor of 1e12"},
    });
}

TEST(SceneJsonErrors, ObjectsStayWhereFloatReaches) {
    const std::string moving =
        replaced(good, object_line, R"({"shape": "sphere", "material": "m", "velocity": [0, -1e18, 0]})");
    EXPECT_EQ(error_of(moving), "");
    EXPECT_EQ(error_of(replaced(moving, resolution_line, resolution_line + R"(, "shutter": {"close": 1})")), "");
    EXPECT_EQ(error_of(replaced(moving, resolution_line, resolution_line + R"(, "shutter": {"close": 2})")),
              "s.json: $.objects[0].velocity: found a place beyond 1e18 at time 2, allowed: a velocity that keeps the "
              "object within -1e18 to 1e18 while the shutter is open");
}

TEST(SceneJsonErrors, AreOneLineWhateverTheFileSays) {
    EXPECT_EQ(error_of(replaced(replaced(good, "\"m\": ", "\"a\\nb\": "), "0.25", "2")),
              "s.json: $.materials.a\\x0ab.albedo[1]: found 2, allowed: a number from 0 to 1");
}

TEST(SceneJsonErrors, NoMoreLevelsThan64) {
    const auto nested = [](std::size_t levels) { return std::string(levels, '[') + std::string(levels, ']'); };
    EXPECT_EQ(error_of(nested(64)), "s.json: $: found an array of 1, allowed: an object");
    const std::string message = error_of(nested(65));
    EXPECT_TRUE(message.ends_with(": found arrays and objects within each other, allowed: 64 levels of them"))
        << message;
}

TEST(SceneJsonErrors, QuadsNeedNoInside) {
    const std::string quad = replaced(good, "\"sphere\"", "\"quad\"");
    const std::string message =
        "s.json: $.objects[0].material: found \"m\", allowed: on a quad: diffuse, emitter, mirror, mix, "
        "rough_conductor or principled without transmission (dielectric, rough_dielectric and subsurface need a "
        "shape with an inside)";
    EXPECT_EQ(error_of(replaced(quad, material_line, R"({"type": "dielectric", "ior": 1.5})")), message);
    EXPECT_EQ(error_of(replaced(quad, material_line, R"({"type": "rough_dielectric", "ior": 1.5, "roughness": 0.1})")),
              message);
    EXPECT_EQ(error_of(replaced(quad, material_line, R"({"type": "subsurface", "sigma_s": [1, 1, 1]})")), message);
    const std::string start = R"({"type": "principled", "base_colour": [1, 1, 1], "roughness": 0, )";
    EXPECT_EQ(error_of(replaced(quad, material_line, start + R"("transmission": 0.5})")), message);
    EXPECT_EQ(error_of(replaced(quad, material_line, start + R"("transmission": 0.5, "metallic": 1})")), "");
    EXPECT_EQ(error_of(quad), "");
}

// To the parser it is the end of the text, wherever it stands.
TEST(SceneJsonErrors, ByteZero) {
    const std::string message = "found the byte 0, allowed: text without it";
    EXPECT_EQ(error_of(good + std::string("\n\0,", 3)),
              fmt::format("s.json: line {}: {}", 2 + std::count(good.begin(), good.end(), '\n'), message));
    EXPECT_EQ(error_of(std::string(1, '\0')), "s.json: line 1: " + message);
}

// The parser's words for it differ between its versions.
TEST(SceneJsonErrors, EmptyText) {
    EXPECT_TRUE(error_of("").starts_with("s.json: not valid JSON: parse error at line 1, column 1: ")) << error_of("");
}

// Deep enough to overflow the stack of whatever recurses.
TEST(SceneJsonErrors, DeepNestingIsAnErrorToo) {
    const std::string deep = std::string(100000, '[') + std::string(100000, ']');
    const std::string message = error_of(replaced(good, "\"good\"", deep));
    EXPECT_TRUE(message.starts_with("s.json: $.name[0]")) << message;
    EXPECT_TRUE(message.ends_with(": found arrays and objects within each other, allowed: 64 levels of them"))
        << message;
}

TEST(SceneJsonErrors, MissingFile) {
    try {
        load_scene("/nowhere/s.json");
        FAIL() << "a missing file was loaded";
    } catch (const InputError& error) {
        EXPECT_STREQ(error.what(),
                     "/nowhere/s.json: the file: found no such file, allowed: a regular file of at most 64 MiB that "
                     "can be read");
    }
}

}  // namespace
}  // namespace pt
