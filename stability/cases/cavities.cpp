// Cases S1 to S5: closed spaces in which every path returns the same number, and a lamp at the centre of a sphere.
#include <cmath>

#include "stability/oracles/furnace.h"
#include "stability/oracles/limits.h"

namespace pt::stability::cavities {
namespace {

// A scene whose camera is inside a closed space around the origin, away from its centre.
SceneText inside(const std::string& name, std::uint32_t depth) {
    SceneText scene(name);
    scene.camera({0.25, 0.5, -0.125}, {0.5, -0.25, 1}).image(8, 8, 90, true).depth(depth);
    return scene;
}

std::vector<Rendering> sphere_furnace(const Values& v) {
    const double emission = std::exp2(-v["k"]);
    const double albedo = 1 - emission;
    SceneText scene = inside("furnace_sphere", v.whole("depth"));
    scene.sphere(scene.diffuse(Vec3d(albedo), Vec3d(emission)), {0, 0, 0}, 2 * v["radius"]);
    return {furnace_rendering(scene, emission, albedo, v.whole("depth"))};
}

std::vector<Rendering> box_furnace(const Values& v) {
    const double emission = std::exp2(-v["k"]);
    const double albedo = 1 - emission;
    SceneText scene = inside("furnace_box", v.whole("depth"));
    const std::string wall = scene.diffuse(Vec3d(albedo), Vec3d(emission));
    const Vec3d half(1, 1.5, 2);
    if (v["walls"] == 0) {
        scene.room(wall, {0, 0, 0}, half);
    } else {
        scene.box(wall, {0, 0, 0}, half * 2.0, v["walls"] == 1 ? Vec3d(0.0) : Vec3d(20, 30, 40));
    }
    return {furnace_rendering(scene, emission, albedo, v.whole("depth"))};
}

std::vector<Rendering> mix_furnace(const Values& v) {
    const double emission = std::exp2(-v["k"]);
    const double albedo = 1 - emission;
    SceneText scene = inside("furnace_mix", v.whole("depth"));
    scene.sphere(scene.mix(Vec3d(albedo), Vec3d(albedo), v["mirror"], Vec3d(emission)), {0, 0, 0}, 2);
    return {furnace_rendering(scene, emission, albedo, v.whole("depth"))};
}

// A lit room with a ball whose material is a mix with only one lobe or, without `as_mix`, that lobe's own material.
Json room_with_ball(bool as_mix, bool mirror) {
    const Vec3d colour(0.875, 0.75, 0.5);
    SceneText scene("mix_pure");
    scene.camera({0.25, 0.5, -1.75}, {0, -0.25, 1}).image(16, 16, 70, true).depth(8);
    scene.room(scene.diffuse({0.75, 0.5, 0.25}), {0, 0, 0}, {1, 1, 2});
    scene.box(scene.emitter({4, 3, 2}), {0, 0.9375, 0}, {0.5, 0.125, 0.5});
    scene.sphere(as_mix   ? scene.mix(mirror ? Vec3d(0.25) : colour, mirror ? colour : Vec3d(0.25), mirror ? 1 : 0)
                 : mirror ? scene.mirror(colour)
                          : scene.diffuse(colour),
                 {0.125, -0.25, 0.5}, 1);
    return scene.json();
}

std::vector<Twins> pure_mixes(const Values&) {
    return {{.change = "mix with mirror probability 0, and diffuse",
             .reference = room_with_ball(false, false),
             .changed = room_with_ball(true, false)},
            {.change = "mix with mirror probability 1, and mirror",
             .reference = room_with_ball(false, true),
             .changed = room_with_ball(true, true)}};
}

// The sphere of pbrt's test scenes, with wall albedo 0.5 and radiance 1 everywhere. A lamp at the centre with radius a
// replaces pbrt's point light of power pi times 4 pi; for a = 0 the wall emits instead.
std::vector<Rendering> pbrt_sphere(const Values& v) {
    const double a = v["a"];
    SceneText scene("pbrt_sphere");
    scene.camera({0, 0, -0.5}, {1, 0, -0.5}).image(1, 1, 1, false).depth(v.whole("depth"));
    scene.sphere(scene.diffuse(Vec3d(0.5), Vec3d(a == 0 ? 0.5 : 0)), {0, 0, 0}, 2);
    double exact = furnace(0.5, 0.5, v["depth"]);
    if (a > 0) {
        scene.sphere(scene.emitter(Vec3d(1 / (a * a))), {0, 0, 0}, 2 * a);
        exact = lamp_radiance(a, 0.5, v["depth"] - 1) / (a * a);
    }
    return {{.scene = scene.json(),
             .quick_paths = paths_for(1e6, v["depth"]),
             .full_paths = paths_for(3e7, v["depth"]),
             .quantities = {mean_is("radiance of the wall", exact,
                                    Tolerance::relative(exact, 1e-5, 1e-12, "numerics.md S4 and S5"))}}};
}

std::vector<Rendering> lamp(const Values& v) {
    SceneText scene("lamp");
    const double a = v["a"];
    // The camera looks along a chord of the sphere that misses the lamp at its centre.
    scene.camera({0, 0, -0.5}, {1, 0, -0.5}).image(1, 1, 1, false).depth(v.whole("depth"));
    scene.sphere(scene.diffuse(Vec3d(v["albedo"])), {0, 0, 0}, 2);
    scene.sphere(scene.emitter(Vec3d(1.0)), {0, 0, 0}, 2 * a);
    const double exact = lamp_radiance(a, v["albedo"], v["depth"] - 1);
    return {{.scene = scene.json(),
             .quick_paths = paths_for(1e6, v["depth"]),
             .full_paths = paths_for(1e8, v["depth"]),
             .quantities = {
                 mean_is("radiance of the wall", exact, Tolerance::relative(exact, 1e-5, 1e-12, "numerics.md S5"))}}};
}

std::string limit_of_lamp(const Values& v, const VariantTraits& variant) {
    const double s = v["a"] * v["a"];
    return rare_or_dim(variant, (v["depth"] - 1) * s, 1, lamp_radiance(v["a"], v["albedo"], v["depth"] - 1),
                       1e6 / v["depth"]);
}

std::string limit_of_pbrt(const Values& v, const VariantTraits& variant) {
    const double s = v["a"] * v["a"];
    return s > 0 ? rare_or_dim(variant, s, 1 / s, 1, 1e6 / v["depth"]) : "";
}

std::string limit_of_furnace(const Values& v, const VariantTraits& variant) {
    const double emission = std::exp2(-v["k"]);
    return lost_tail(emission, 1 - emission, v["depth"], variant);
}

constexpr const char* furnace_formula = "E (1 - rho^D) / (1 - rho), E = 2^-k, rho = 1 - 2^-k";
const Parameter emission_exponent{"k", 1, 1, 24, "emission 2^-k, albedo 1 - 2^-k", true};
const Parameter furnace_depth{"depth", 9, 1, 1000000, "ray segments of a path", true};

const CasesOf<Family::cavities> cases({
    {.name = "furnace_sphere",
     .catalogue = "S1",
     .title = "a glowing sphere from within",
     .stiff = "paths of up to 131072 segments with an albedo of 1 - 2^-17: every rounding of the throughput is summed",
     .formula = furnace_formula,
     .parameters = {emission_exponent, furnace_depth, {"radius", 1, 1, 1000, "of the sphere, scene units"}},
     .points = table({"k", "depth"}, {{1, 9}, {3, 9}, {10, 1024}, {17, 131072}}),
     .quick_points = table({"k", "depth"}, {{1, 9}, {10, 1024}}),
     .sweep = "k",
     .renderings = sphere_furnace,
     .known_limit = limit_of_furnace},
    {.name = "furnace_box",
     .catalogue = "S2",
     .title = "a glowing box from within: six quads, or one box inside out",
     .stiff = "walls that meet in edges and corners: a path that slips out between two of them takes its light along",
     .formula = furnace_formula,
     .parameters = {{"walls", 0, 0, 2, "0: six quads, 1: a box, 2: a turned box", true},
                    emission_exponent,
                    furnace_depth},
     .points = table({"walls", "k", "depth"},
                     {{0, 10, 1024}, {1, 10, 1024}, {2, 10, 1024}, {0, 1, 9}, {1, 1, 9}, {2, 1, 9}}),
     .quick_points = table({"walls", "k", "depth"}, {{0, 10, 1024}, {1, 10, 1024}, {2, 10, 1024}}),
     .renderings = box_furnace,
     .known_limit = limit_of_furnace},
    {.name = "furnace_mix",
     .catalogue = "S3",
     .title = "a glowing sphere whose wall is a mix of mirror and diffuse",
     .stiff = "a lobe chosen once in 2^20 times, or never, or always: weights that are divided by its probability show",
     .formula = "E (1 - rho^D) / (1 - rho) for every mirror probability",
     .parameters = {{"mirror", 0.5, 0, 1, "probability of the mirror"}, emission_exponent, furnace_depth},
     .points = table({"mirror", "k", "depth"},
                     {{0, 3, 64}, {0x1p-20, 3, 64}, {0.5, 3, 64}, {1, 3, 64}, {0.5, 10, 1024}}),
     .quick_points = table({"mirror", "k", "depth"}, {{0x1p-20, 3, 64}, {0.5, 10, 1024}}),
     .sweep = "mirror",
     .renderings = mix_furnace,
     .known_limit = limit_of_furnace},
    {.name = "mix_pure",
     .catalogue = "S3",
     .title = "a mix with probability 0 or 1 is the pure material",
     .stiff = "a comparison u < p that is never, or always, to be true: u = 0 and u = 1 decide",
     .formula = "the same film, bit for bit",
     .twins = pure_mixes},
    {.name = "pbrt_sphere",
     .catalogue = "S4",
     .title = "pbrt's test scenes, whose radiance is 1",
     .stiff = "nearly a point light: a lamp of radiance 1 / a^2 inside a wall that reflects half of it",
     .formula = "glowing walls: 1 - 2^-D; a lamp for a point light: that of S5 over a^2, 1 / (1 + a^2) at great depth",
     .parameters = {{"a", 0, 0, 0.4375, "radius of the lamp over that of the wall; 0: the wall glows"},
                    {"depth", 21, 2, 100000, "ray segments of a path", true}},
     .points = along("a", {0, 0.25, 0.0625}),
     .quick_points = along("a", {0, 0.25}),
     .sweep = "a",
     .estimators = {{axes::direct_light, {"nee", "nee_mis"}}},
     .renderings = pbrt_sphere,
     .known_limit = limit_of_pbrt},
    {.name = "lamp",
     .catalogue = "S5",
     .title = "a lamp at the centre of a diffuse sphere",
     .stiff = "the smaller the lamp, the rarer and brighter the paths that find it; a cone of 1 - cos loses its digits",
     .formula = "sum over j of rho^j (1 - a^2)^(j-1) a^2: the wall sees the lamp with the view factor a^2",
     .parameters = {{"a", 0.1, 1e-6, 0.45, "radius of the lamp over that of the wall"},
                    {"albedo", 0.5, 0, 1, "of the wall"},
                    {"depth", 9, 2, 100000, "ray segments of a path", true}},
     .points =
         {{{"a", 0.1}}, {{"a", 0.1}, {"albedo", 0.9}}, {{"a", 0.01}, {"albedo", 0.9}}, {{"a", 0.001}, {"depth", 3}}},
     .sweep = "a",
     .estimators = {{axes::direct_light, {"nee", "nee_mis"}}},
     .renderings = lamp,
     .known_limit = limit_of_lamp},
});

}  // namespace
}  // namespace pt::stability::cavities
