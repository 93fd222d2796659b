// The importer of the CIS 565 text format: the two scenes of cis565, every reading that its header states. What it says
// of a text is tested in import_findings_test.cpp.
#include "harness/interchange/import_cis565.h"

#include <gtest/gtest.h>

#include "tests/support/cis565_texts.h"
#include "tests/support/places.h"
#include "tests/support/render.h"
#include "tests/support/statistics.h"

namespace pt {
namespace {

using test::plain_camera, test::replaced, test::with_material;

// The two scenes of cis565, as they come. They share materials and camera.
const std::string cis565_materials_and_camera = R"(MATERIAL 0
RGB 1 1 1
SPECEX 0
SPECRGB 0 0 0
REFL 0
REFR 0
REFRIOR 0
EMITTANCE 5
SIGMAA 0 0 0
SIGMAS 0 0 0

MATERIAL 1
RGB 0.98 0.98 0.98
SPECEX 0
SPECRGB 0 0 0
REFL 0
REFR 0
REFRIOR 0
EMITTANCE 0
SIGMAA 0 0 0
SIGMAS 0 0 0

MATERIAL 2
RGB 0.85 0.35 0.35
SPECEX 0
SPECRGB 0 0 0
REFL 0
REFR 0
REFRIOR 0
EMITTANCE 0
SIGMAA 0 0 0
SIGMAS 0 0 0

MATERIAL 3
RGB 0.35 0.85 0.35
SPECEX 0
SPECRGB 0 0 0
REFL 0
REFR 0
REFRIOR 0
EMITTANCE 0
SIGMAA 0 0 0
SIGMAS 0 0 0

MATERIAL 4
RGB 0.98 0.98 0.98
SPECEX 0
SPECRGB 0.98 0.98 0.98
REFL 1
REFR 0
REFRIOR 0
EMITTANCE 0
SIGMAA 0 0 0
SIGMAS 0 0 0

MATERIAL 5
RGB 0.98 0.98 0.98
SPECEX 0
SPECRGB 0.98 0.98 0.98
REFL 0
REFR 1
REFRIOR 1.5
EMITTANCE 0
SIGMAA 0 0 0
SIGMAS 0 0 0

CAMERA
RES 800 800
FOVY 45
ITERATIONS 5000
DEPTH 8
FILE cornell
EYE 0.0 5 10.5
LOOKAT 0 5 0
UP 0 1 0


)";
const std::string cis565_open_objects = R"(OBJECT 0
cube
material 0
TRANS 0 10 0
ROTAT 0 0 0
SCALE 3 0.3 3
VEL 0 0 0

OBJECT 1
cube
material 1
TRANS 0 0 0
ROTAT 0 0 0
SCALE 10 0.01 10
VEL 0 0 0

OBJECT 2
cube
material 1
TRANS 0 10 0
ROTAT 0 0 90
SCALE 0.01 10 10
VEL 0 0 0

OBJECT 3
cube
material 1
TRANS 0 5 -5
ROTAT 0 90 0
SCALE 0.01 10 10
VEL 0 0 0

OBJECT 4
cube
material 2
TRANS -5 5 0
ROTAT 0 0 0
SCALE 0.01 10 10
VEL 0 0 0

OBJECT 5
cube
material 3
TRANS 5 5 0
ROTAT 0 0 0
SCALE 0.01 10 10
VEL 0 0 0

OBJECT 6
sphere
material 4
TRANS -1 4 -1
ROTAT 0 0 0
SCALE 3 3 3
VEL 0 0 0

)";
const std::string cis565_closed_objects = R"(OBJECT 0
cube
material 0
TRANS 0 10 0
ROTAT 0 0 0
SCALE 3 0.3 3
VEL 0 0 0

OBJECT 1
cube
material 1
TRANS 0 0 5
ROTAT 0 0 0
SCALE 10 0.01 20
VEL 0 0 0

OBJECT 2
cube
material 1
TRANS 0 10 5
ROTAT 0 0 90
SCALE 0.01 10 20
VEL 0 0 0

OBJECT 3
cube
material 1
TRANS 0 5 -5
ROTAT 0 90 0
SCALE 0.01 10 10
VEL 0 0 0

OBJECT 4
cube
material 2
TRANS -5 5 5
ROTAT 0 0 0
SCALE 0.01 10 20
VEL 0 0 0

OBJECT 5
cube
material 3
TRANS 5 5 5
ROTAT 0 0 0
SCALE 0.01 10 20
VEL 0 0 0

OBJECT 6
sphere
material 4
TRANS -1 4 -1
ROTAT 0 0 0
SCALE 3 3 3
VEL 0 0 0

OBJECT 7
cube
material 1
TRANS 0 5 15
ROTAT 0 90 0
SCALE 0.01 10 10
VEL 0 0 0

)";

Scene import(const std::string& text) {
    return parse_scene(import_cis565_scene(text, "cis565.txt").json, "cis565.json");
}

SceneMaterial import_material(const std::string& lines) { return import(with_material(lines)).materials.at(0); }

void expect_equal_materials(const SceneMaterial& a, const SceneMaterial& b) {
    EXPECT_EQ(a.type, b.type);
    EXPECT_EQ(a.albedo, b.albedo);
    EXPECT_EQ(a.emission, b.emission);
    EXPECT_EQ(a.reflectance, b.reflectance);
    EXPECT_EQ(a.tint, b.tint);
    EXPECT_EQ(a.sigma_a, b.sigma_a);
    EXPECT_EQ(a.sigma_s, b.sigma_s);
    EXPECT_EQ(a.mirror_probability, b.mirror_probability);
    EXPECT_EQ(a.ior, b.ior);
    EXPECT_EQ(a.g, b.g);
    EXPECT_EQ(a.max_scatterings, b.max_scatterings);
}

void expect_equal_cameras(const SceneCamera& a, const SceneCamera& b) {
    EXPECT_EQ(a.eye, b.eye);
    EXPECT_EQ(a.look_at, b.look_at);
    EXPECT_EQ(a.up, b.up);
    EXPECT_EQ(a.vertical_fov_degrees, b.vertical_fov_degrees);
    EXPECT_EQ(a.width, b.width);
    EXPECT_EQ(a.height, b.height);
    EXPECT_EQ(a.jitter, b.jitter);
    EXPECT_EQ(a.aperture_radius, b.aperture_radius);
    EXPECT_EQ(a.focus_distance, b.focus_distance);
    EXPECT_EQ(a.shutter_open, b.shutter_open);
    EXPECT_EQ(a.shutter_close, b.shutter_close);
    EXPECT_EQ(a.shutter_late, b.shutter_late);
}

// Names and the description aside, and materials that no object has.
void expect_equal_scenes(Scene a, Scene b) {
    EXPECT_EQ(a.max_depth, b.max_depth);
    EXPECT_EQ(a.environment, b.environment);
    expect_equal_cameras(a.camera, b.camera);
    ASSERT_EQ(a.objects.size(), b.objects.size());
    for (std::size_t i = 0; i < a.objects.size(); ++i) {
        SCOPED_TRACE(i);
        EXPECT_EQ(a.objects[i].shape, b.objects[i].shape);
        EXPECT_EQ(a.objects[i].translate, b.objects[i].translate);
        EXPECT_EQ(a.objects[i].rotate_degrees, b.objects[i].rotate_degrees);
        EXPECT_EQ(a.objects[i].scale, b.objects[i].scale);
        EXPECT_EQ(a.objects[i].velocity, b.objects[i].velocity);
        expect_equal_materials(a.materials[a.objects[i].material], b.materials[b.objects[i].material]);
    }
    a.camera.width = a.camera.height = b.camera.width = b.camera.height = 16;
    EXPECT_EQ(test::render_variant(a, {}).hash(), test::render_variant(b, {}).hash());
}

Scene shipped(const std::string& name) { return load_scene(test::in_source("scenes/" + name + ".json")); }

TEST(ImportCis565, OpenBoxIsTheShippedOne) {
    expect_equal_scenes(import(cis565_materials_and_camera + cis565_open_objects), shipped("cornell_open"));
}

TEST(ImportCis565, ClosedBoxIsTheShippedOne) {
    expect_equal_scenes(import(cis565_materials_and_camera + cis565_closed_objects), shipped("cornell_closed"));
}

TEST(ImportCis565, WritesTidyJson) {
    const std::string text = "MATERIAL 0\nRGB .5 0.25 1\n" + plain_camera +
                             "OBJECT 0\nsphere\nmaterial 0\nTRANS 0 -1.5 0\nROTAT 0 90 0\nSCALE 3 3 3\n"
                             "OBJECT 1\ncube\nmaterial 0\nTRANS 0 0 0\nROTAT 0 0 0\nSCALE 1 1 1\nVEL 1 0 0\n";
    EXPECT_EQ(import_cis565_scene(text, "some/where/cis565.txt").json, R"({
  "name": "plain",
  "description": "Imported from cis565.txt.",
  "max_depth": 5,
  "camera": {"eye": [1, 2, 3], "look_at": [1, 2, 0], "up": [0, 1, 0], "vertical_fov_degrees": 60, "resolution": [40, 30],
    "shutter": {"open": 0, "close": 1, "density": "late"}},
  "materials": {
    "material_0": {"type": "diffuse", "albedo": [0.5, 0.25, 1]}
  },
  "objects": [
    {"shape": "sphere", "material": "material_0", "translate": [0, -1.5, 0], "rotate_degrees": [0, 90, 0], "scale": 3},
    {"shape": "box", "material": "material_0", "velocity": [1, 0, 0]}
  ]
}
)");
}

TEST(ImportCis565, WhiteSpaceCommentsAndOrderOfLinesDoNotMatter) {
    const std::string text = with_material("RGB 1 1 1\n");
    const std::string windows = replaced(replaced(text, "RGB 1 1 1\n", "  RGB\t1 +1 1 \r\n\r\n// a comment\r\n"),
                                         "cube\nmaterial 0\n", "material 0\ncube\n");
    EXPECT_EQ(import_cis565_scene(text, "cis565.txt").json, import_cis565_scene(windows, "cis565.txt").json);
}

TEST(ImportCis565, CameraIsReadInBothDialects) {
    const std::string text = with_material("RGB 1 1 1\n");
    EXPECT_EQ(import(text).camera.vertical_fov_degrees, 60);
    EXPECT_EQ(import(text).camera.look_at, Vec3d(1, 2, 0));
    EXPECT_EQ(import(replaced(text, "LOOKAT 1 2 0", "VIEW 0 0 -1")).camera.look_at, Vec3d(1, 2, 2));
    EXPECT_EQ(import(replaced(text, "ITERATIONS 10\n", "")).max_depth, 5u);
}

TEST(ImportCis565, VelocityOpensTheShutterLate) {
    const Scene still = import(with_material("RGB 1 1 1\n") + "VEL 0 0 0\n");
    EXPECT_EQ(still.camera.shutter_close, 0);
    const Scene moving = import(with_material("RGB 1 1 1\n") + "VEL 0 -2 0\n");
    EXPECT_EQ(moving.objects[0].velocity, Vec3d(0, -2, 0));
    EXPECT_EQ(moving.camera.shutter_open, 0);
    EXPECT_EQ(moving.camera.shutter_close, 1);
    EXPECT_TRUE(moving.camera.shutter_late);
}

TEST(ImportCis565, DiffuseMaterial) {
    const SceneMaterial material = import_material("RGB .1 .2 .3\nSPECRGB .9 .9 .9\nSIGMAA 1 1 1\nREFRIOR 1.5\n");
    EXPECT_EQ(material.type, MaterialType::diffuse);
    EXPECT_EQ(material.albedo, Vec3d(.1, .2, .3));
}

TEST(ImportCis565, Emitter) {
    const SceneMaterial material = import_material("RGB 1 .5 .25\nEMITTANCE 4\nREFL 1\n");
    EXPECT_EQ(material.type, MaterialType::emitter);
    EXPECT_EQ(material.emission, Vec3d(4, 2, 1));
}

TEST(ImportCis565, Mirror) {
    const SceneMaterial material = import_material("RGB .1 .2 .3\nSPECRGB .7 .8 .9\nREFL 1\nSPECEX 5\n");
    EXPECT_EQ(material.type, MaterialType::mirror);
    EXPECT_EQ(material.reflectance, Vec3d(.7, .8, .9));
    EXPECT_EQ(import_material("RGB .1 .2 .3\nSPECRGB 0 0 0\nREFL 1\n").reflectance, Vec3d(.1, .2, .3));
}

TEST(ImportCis565, Dielectric) {
    const SceneMaterial material =
        import_material("RGB .1 .2 .3\nSPECRGB .7 .8 .9\nREFR 1\nREFRIOR 1.5\nSIGMAA 0 1 2\n");
    EXPECT_EQ(material.type, MaterialType::dielectric);
    EXPECT_EQ(material.tint, Vec3d(.7, .8, .9));
    EXPECT_EQ(material.ior, 1.5);
    EXPECT_EQ(material.sigma_a, Vec3d(0, 1, 2));
    EXPECT_EQ(import_material("RGB .1 .2 .3\nREFR 1\nREFRIOR 1.5\n").tint, Vec3d(.1, .2, .3));
}

TEST(ImportCis565, ImperfectSpecularIsAMix) {
    const SceneMaterial material = import_material("RGB .1 .2 .3\nSPECRGB .7 .8 .9\nSPECEX 40\n");
    EXPECT_EQ(material.type, MaterialType::mix);
    EXPECT_EQ(material.albedo, Vec3d(.1, .2, .3));
    EXPECT_EQ(material.reflectance, Vec3d(.7, .8, .9));
    EXPECT_EQ(material.mirror_probability, 0.5);
}

TEST(ImportCis565, Subsurface) {
    const SceneMaterial matched = import_material("RGB 1 1 1\nSIGMAA .1 .2 .3\nSIGMAS 1 2 3\n");
    EXPECT_EQ(matched.type, MaterialType::subsurface);
    EXPECT_EQ(matched.ior, 1);
    EXPECT_EQ(matched.sigma_a, Vec3d(.1, .2, .3));
    EXPECT_EQ(matched.sigma_s, Vec3d(1, 2, 3));
    const SceneMaterial refracting = import_material("RGB 1 1 1\nREFR 1\nREFRIOR 1.3\nSIGMAS 1 2 3\n");
    EXPECT_EQ(refracting.type, MaterialType::subsurface);
    EXPECT_EQ(refracting.ior, 1.3);
}

TEST(ImportCis565, SingleRotationsKeepTheirDigits) {
    for (const Vec3d& degrees : {Vec3d(0, 0, 0), Vec3d(17.3, 0, 0), Vec3d(0, -400.1, 0), Vec3d(0, 0, 90)}) {
        EXPECT_EQ(rotation_x_first(degrees), degrees);
    }
}

// Rx Ry Rz as it stands, from three rotations about one axis.
Rotation product_xyz(const Vec3d& degrees) {
    const Rotation factors[] = {rotation_of({degrees.x, 0, 0}), rotation_of({0, degrees.y, 0}),
                                rotation_of({0, 0, degrees.z})};
    const auto apply = [](const Rotation& r, const Vec3d& v) {
        return r.column[0] * v.x + r.column[1] * v.y + r.column[2] * v.z;
    };
    Rotation product{};
    for (int i = 0; i < 3; ++i) {
        product.column[i] = apply(factors[0], apply(factors[1], factors[2].column[i]));
    }
    return product;
}

double largest_difference(const Rotation& a, const Rotation& b) {
    double largest = 0;
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            largest = std::max(largest, std::abs(a.column[i][j] - b.column[i][j]));
        }
    }
    return largest;
}

TEST(ImportCis565, RotationsGiveTheMatrixOfCis565) {
    test::Random random(1);
    for (int i = 0; i < 10000; ++i) {
        const Vec3d degrees{random.uniform(-400, 400), random.uniform(-400, 400), random.uniform(-400, 400)};
        ASSERT_LT(largest_difference(product_xyz(degrees), rotation_of(rotation_x_first(degrees))), 4e-14);
    }
}

// Rotations near the poles of ours: the x of cis565 turned by z = 90 degrees about it, and close to that.
TEST(ImportCis565, RotationsGiveTheMatrixOfCis565NearThePoles) {
    test::Random random(2);
    for (int i = 0; i < 10000; ++i) {
        const double off = std::pow(10.0, random.uniform(-17, 0));
        const Vec3d degrees[] = {{random.uniform(-180, 180), 90 + off, random.uniform(-180, 180)},
                                 {90 + off, random.uniform(-180, 180), 90},
                                 {90, off, 90 - off}};
        for (const Vec3d& d : degrees) {
            ASSERT_LT(largest_difference(product_xyz(d), rotation_of(rotation_x_first(d))), 4e-14)
                << d.x << " " << d.y << " " << d.z;
        }
    }
}

TEST(ImportCis565, QuarterTurnsStayExact) {
    for (int code = 0; code < 9 * 9 * 9; ++code) {
        const Vec3d degrees{90.0 * (code % 9 - 4), 90.0 * (code / 9 % 9 - 4), 90.0 * (code / 81 - 4)};
        const Vec3d ours = rotation_x_first(degrees);
        EXPECT_EQ(largest_difference(product_xyz(degrees), rotation_of(ours)), 0)
            << degrees.x << " " << degrees.y << " " << degrees.z;
        EXPECT_EQ(classify({.shape = Shape::box, .rotate_degrees = ours}), ShapeKind::axis_box);
    }
}

}  // namespace
}  // namespace pt
