// Cases S39 to S42: path throughput, from vanishing values to a light found by one path in a million.
#include <cmath>

#include "stability/oracles/caustic.h"
#include "stability/oracles/furnace.h"
#include "stability/oracles/limits.h"

namespace pt::stability::throughput {
namespace {

Rendering wall_rendering(const SceneText& scene, double exact, double segments_per_path, const Tolerance& tolerance) {
    return {.scene = scene.json(),
            .quick_paths = paths_for(1e6, segments_per_path),
            .full_paths = paths_for(6e7, segments_per_path),
            .quantities = {mean_is("radiance of the wall", exact, tolerance)}};
}

// A scene whose camera looks along a chord of a sphere, inside it, that misses the sphere's centre.
SceneText at_the_wall(const std::string& name, std::uint32_t depth) {
    SceneText scene(name);
    scene.camera({0, 0, -0.5}, {1, 0, -0.5}).image(1, 1, 1, false).depth(depth);
    return scene;
}

// A sphere whose wall has a tiny albedo in one channel, 0 in another and a larger one in the third.
std::vector<Rendering> dark_walls(const Values& v) {
    const double albedo = v["log10_albedo"] <= -400 ? 0 : std::pow(10.0, v["log10_albedo"]);
    const auto depth = v.whole("depth");
    SceneText scene = at_the_wall("tiny_albedo", depth);
    scene.sphere(scene.diffuse({albedo, 0, v["other"]}, Vec3d(1.0)), {0, 0, 0}, 2);
    Rendering rendering{.scene = scene.json(),
                        .quick_paths = paths_for(1e6, depth),
                        .full_paths = paths_for(3e7, depth),
                        .quantities = {}};
    const double albedos[] = {albedo, 0, v["other"]};
    const char* const names[] = {"radiance, tiny albedo", "radiance, albedo 0", "radiance, the other albedo"};
    for (int channel = 0; channel < 3; ++channel) {
        rendering.quantities.push_back({.name = names[channel],
                                        .of = [channel](const RenderResult& r) { return mean_channel(r, channel); },
                                        .exact = furnace(1, albedos[channel], depth),
                                        .tolerance = furnace_tolerance(1, albedos[channel], depth)});
    }
    return {rendering};
}

std::vector<Rendering> firefly(const Values& v) {
    const double a = v["a"], albedo = v["albedo"];
    SceneText scene = at_the_wall("firefly", v.whole("depth"));
    scene.sphere(scene.diffuse(Vec3d(albedo)), {0, 0, 0}, 2);
    scene.sphere(scene.emitter(Vec3d(1 / (a * a))), {0, 0, 0}, 2 * a);
    const double exact = lamp_radiance(a, albedo, v["depth"] - 1) / (a * a);
    return {
        wall_rendering(scene, exact, v["depth"], Tolerance::relative(exact, 1e-5, 1e-12, "numerics.md S5 and S40"))};
}

std::string limit_of_fireflies(const Values& v, const VariantTraits& variant) {
    const double s = v["a"] * v["a"];
    return rare_or_dim(variant, (v["depth"] - 1) * s, 1 / s, v["albedo"], 1e6 / v["depth"]);
}

std::string limit_of_albedo(const Values& v, const VariantTraits& variant) {
    const double albedo = std::max(v["other"], std::pow(10.0, v["log10_albedo"]));
    return !variant.russian_roulette.ends_paths ? lost_tail(1, albedo, v["depth"], variant) : "";
}

std::vector<Rendering> caustic(const Values& v) {
    constexpr double albedo = 0.5, ball = 0.4;
    const double share = glazed_lamp_share(v["a"], ball, v["ior"]);
    SceneText scene = at_the_wall("caustic", 96);
    scene.sphere(scene.diffuse(Vec3d(albedo)), {0, 0, 0}, 2);
    scene.sphere(scene.dielectric(v["ior"]), {0, 0, 0}, 2 * ball);
    scene.sphere(scene.emitter(Vec3d(1.0)), {0, 0, 0}, 2 * v["a"]);
    const double exact = albedo * share / (1 - albedo * (1 - share));
    // Between two reflections at the wall a path has one to three segments (past, off or through the glass ball), plus
    // one for every internal reflection; after a depth of 96 at most 2^-24 of the light is missing.
    return {
        wall_rendering(scene, exact, 40,
                       Tolerance::relative(exact, 1e-5 + 0x1p-24, 1e-12 + 0x1p-24,
                                           "numerics.md S5, and the light of more than 24 reflections at the wall"))};
}

// The wall is white, so every path finds the lamp of radius a if it may, after 1 / a^2 segments on average.
std::vector<Rendering> deep_lamp(const Values& v) {
    const double a = v["a"];
    SceneText scene = at_the_wall("deep_lamp", v.whole("depth"));
    scene.sphere(scene.diffuse(Vec3d(1.0)), {0, 0, 0}, 2);
    scene.sphere(scene.emitter(Vec3d(1.0)), {0, 0, 0}, 2 * a);
    const double exact = -std::expm1((v["depth"] - 1) * std::log1p(-a * a));
    return {wall_rendering(scene, exact, std::min(v["depth"], 1 / (a * a)),
                           Tolerance::relative(exact, 1e-5, 1e-12, "numerics.md S5"))};
}

const CasesOf<Family::throughput> cases({
    {.name = "tiny_albedo",
     .catalogue = "S39",
     .title = "a glowing sphere that reflects nothing, or 1e-40 of the light",
     .stiff = "a throughput that is 0 or denormal: 0 / 0 in a Russian roulette, and a product that never reaches 0",
     .formula = "E (1 - rho^D) / (1 - rho) by channel",
     .parameters = {{"log10_albedo", -40, -400, 0, "of the first channel; -400: 0"},
                    {"other", 0.5, 0, 1, "albedo of the third channel; that of the second is 0"},
                    {"depth", 64, 1, 1000000, "ray segments of a path", true}},
     .points = joined({along("log10_albedo", {-1, -30, -38, -40, -44}),
                       table({"log10_albedo", "other"}, {{-400, 0}, {-38, 1e-20}}),
                       table({"log10_albedo", "other", "depth"}, {{-40, 0.875, 4096}})}),
     .quick_points = {{{"log10_albedo", -40}}, {{"log10_albedo", -400}, {"other", 0}}},
     .sweep = "log10_albedo",
     .estimators = {{axes::russian_roulette, {"throughput"}}},
     .renderings = dark_walls,
     .known_limit = limit_of_albedo},
    {.name = "firefly",
     .catalogue = "S40",
     .title = "a lamp of radiance 1 / a^2 and radius a",
     .stiff = "one path in 1 / a^2 carries all the light: whatever clamps it, or rounds the others, is a bias",
     .formula = "sum over j of rho^j (1 - a^2)^(j-1)",
     .parameters = {{"a", 0.03125, 1e-6, 0.45, "radius of the lamp over that of the wall"},
                    {"albedo", 0.7, 0, 1, "of the wall"},
                    {"depth", 2, 2, 1000, "ray segments of a path", true}},
     .points = along("a", {0.25, 0.03125, 0.0078125, 0.001}),
     .quick_points = along("a", {0.25, 0.03125}),
     .sweep = "a",
     .estimators = {{axes::direct_light, {"nee", "nee_mis"}}},
     .renderings = firefly,
     .known_limit = limit_of_fireflies},
    {.name = "caustic",
     .catalogue = "S41",
     .title = "a lamp inside a ball of glass: all its light is a caustic",
     .stiff = "no connection reaches the lamp through glass: light that is met by chance has to count in full",
     .formula =
         "rho s / (1 - rho (1 - s)), s = integral of Fresnel's transmittance over the impact parameters that the "
         "ball bends onto the lamp",
     .parameters = {{"ior", 1.5, 1.01, 4, "of the glass"},
                    {"a", 0.2, 0.01, 0.39, "radius of the lamp; the ball's is 0.4"}},
     .points = {{{"ior", 1.5}}, {{"ior", 2.5}}, {{"a", 0.05}}, {{"a", 0.375}}},
     .quick_points = {{{"ior", 1.5}}},
     .sweep = "ior",
     .estimators = {{axes::direct_light, {"nee", "nee_mis"}}},
     .renderings = caustic},
    {.name = "deep_lamp",
     .catalogue = "S42",
     .title = "a small lamp in a white sphere, found after thousands of reflections",
     .stiff = "paths of 1e5 segments: random numbers that repeat, or run into those of the next sample, keep them from "
              "the lamp",
     .formula = "1 - (1 - a^2)^(D - 1)",
     .parameters = {{"a", 0.0625, 1e-4, 0.45, "radius of the lamp over that of the wall"},
                    {"depth", 256, 2, 1000000, "ray segments of a path", true}},
     .points = table({"a", "depth"}, {{0.0625, 256}, {0.015625, 4096}, {0.00390625, 100000}}),
     .quick_points = table({"a", "depth"}, {{0.0625, 256}, {0.015625, 4096}}),
     .sweep = "a",
     .renderings = deep_lamp},
});

}  // namespace
}  // namespace pt::stability::throughput
