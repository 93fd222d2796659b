// Cases S28 and S30: a rod that guides light, and bodies within bodies.
#include <algorithm>
#include <bit>
#include <cmath>

#include "stability/cases/glass.h"

namespace pt::stability::dielectrics_nested {
namespace {

std::vector<Rendering> light_pipe(const Values& v) {
    const double theta = v["theta"], azimuth = v["azimuth"], length = v["length"];
    const Vec3d direction(std::sin(theta) * std::cos(azimuth), std::sin(theta) * std::sin(azimuth), std::cos(theta));
    SceneText scene("light_pipe");
    scene.camera({0, 0, 0}, direction, {0, 1, 0}).depth(without_end);
    const Vec3d aim = direction * (1 / direction.z) - Vec3d(0.125, -0.25, 0);  // centre of the glass rod's front face
    scene.box(scene.dielectric(v["ior"]), {aim.x, aim.y, 1 + length / 2}, {1, 1, length});
    scene.quad(scene.emitter(lamp_behind), {0, 0, length + 2}, 1e6, 1e6, {90, 0, 0});
    scene.quad(scene.emitter(lamp_before), {0, 0, -1}, 1e6, 1e6, {90, 0, 0});
    const Shares exact =
        plate(reflectance(static_cast<long double>(v["ior"]) - 1, std::cos(static_cast<long double>(theta))), 1);
    // The number of paths is a power of two, so that the mean of paths that all return 1 is exactly 1.
    const std::uint64_t paths =
        std::bit_floor(static_cast<std::uint64_t>(std::clamp(1e6 / (length * std::tan(theta) + 4), 1024.0, 65536.0)));
    Rendering rendering{
        .scene = scene.json(), .quick_paths = paths, .full_paths = 64 * paths, .quantities = shares(exact, paths)};
    rendering.quantities.push_back(nothing_lost("what did not leak through the sides"));
    return {rendering};
}

// The index of the inner of two nested balls in the scene file: relative to the outer ball's index or to air.
double inner_index(const Values& v) { return v.is_set("against_air") ? v["inner"] : v["inner"] / v["outer"]; }

std::vector<Rendering> nested_balls(const Values& v) {
    const auto add = [&](SceneText& scene) {
        scene.sphere(scene.dielectric(v["outer"]), {0, 0, 3}, 2);
        scene.sphere(scene.dielectric(inner_index(v)), {0, 0, 3}, 1);
    };
    SceneText axis("nested_axis");
    axis.camera({0, 0, 0}, {0, 0, 1}).depth(without_end);
    add(axis);
    axis.quad(axis.emitter(lamp_behind), {0, 0, 6}, 1e6, 1e6, {90, 0, 0});
    axis.quad(axis.emitter(lamp_before), {0, 0, -1}, 1e6, 1e6, {90, 0, 0});
    const long double inner = v["inner"], outer = v["outer"];
    const Shares outside = boundary(reflectance(outer - 1, 1)), inside = boundary(reflectance(inner / outer - 1, 1));
    const Shares exact = stacked(stacked(stacked(outside, inside), inside), outside);
    const std::uint64_t paths = 1u << 16;
    Rendering along{
        .scene = axis.json(), .quick_paths = paths, .full_paths = 1u << 23, .quantities = shares(exact, paths)};
    along.quantities.push_back(nothing_lost("transmitted and reflected"));
    SceneText image("nested_image");
    image.camera({0, 0, 0}, {0, 0, 3}).image(16, 16, 50, true).depth(without_end).environment(1);
    add(image);
    return {along,
            {.scene = image.json(),
             .quick_paths = 1u << 14,
             .full_paths = 1u << 22,
             .quantities = {all_one("radiance of the pixel that is farthest off")}}};
}

std::vector<Rendering> nested_absorbers(const Values& v) {
    SceneText scene("nested_absorbers");
    scene.camera({0, 0, 0}, {0, 0, 1}).depth(16).environment(1);
    scene.sphere(scene.dielectric(1, Vec3d(v["outer"])), {0, 0, 3}, 2);
    scene.sphere(scene.dielectric(1, Vec3d(v["inner"])), {0, 0, 3}, 1);
    const double exact = std::exp(-v["outer"] - v["inner"]);
    return {{.scene = scene.json(),
             .quick_paths = 16,
             .full_paths = 1024,
             .quantities = {every_pixel_is(
                 "radiance", exact, {1e-6, 1e-12, "chords to some roundings of the distance 4, film's quantum"})}}};
}

const CasesOf<Family::dielectrics> cases({
    {.name = "light_pipe",
     .catalogue = "S28",
     .title = "a glass rod that conducts light",
     .stiff = "thousands of total reflections off the sides, none of which may leak",
     .formula = "T = (1-R) / (1+R) of the two ends, whatever the length: beyond n^2 = 1 + sin^2 the sides reflect all",
     .parameters = {{"length", 50, 1, 1e5, "of the rod, in widths"},
                    {"theta", 0.9, 0.1, 1.5, "angle of incidence on the end, radians"},
                    {"azimuth", 0.7, 0, 6.28, "of the incident ray, radians"},
                    {"ior", 1.5, 1.415, 10, "of the rod, above sqrt(2)"}},
     .points = {{{"length", 1}}, {{"length", 50}}, {{"length", 1000}}, {{"length", 1000}, {"theta", 1.5}}},
     .quick_points = along("length", {1, 1000}),
     .sweep = "length",
     .renderings = light_pipe},
    {.name = "nested_balls",
     .catalogue = "S30",
     .title = "a ball within a glass ball",
     .stiff = "the boundary within is one of two media, neither of which is air",
     .formula = "four boundaries along the axis, with all reflections between them: (1-R) / (1+3R) for a shell; 1 in "
                "even surroundings",
     .parameters = {{"outer", 1.5, 1.1, 4, "index of the outer ball"},
                    {"inner", 1, 0.5, 4, "index of the inner ball, as a medium"},
                    {"against_air", 0, 0, 1,
                     "1: the file gives the inner ball's index against air, 0: against the "
                     "outer ball",
                     true}},
     .points = {{{"inner", 1}}, {{"inner", 1.5}}, {{"inner", 2.4}}, {{"inner", 1.5}, {"against_air", 1}}},
     .quick_points = {{{"inner", 1}}, {{"inner", 1.5}, {"against_air", 1}}},
     .renderings = nested_balls,
     .known_limit = [](const Values& v, const VariantTraits&) -> std::string {
         return v.is_set("against_air")
                    ? "media do not nest: every index is taken as that of the boundary, here of air "
                      "against the inner ball. Cure: give the inner ball the index inner / outer, "
                      "or a stack of media in the path"
                    : "";
     }},
    {.name = "nested_absorbers",
     .catalogue = "S30",
     .title = "an absorbing ball within an absorbing ball",
     .stiff = "on leaving the inner ball the path is in the outer one again",
     .formula = "exp(-(s_outer 2 (1 - 1/2) + s_inner 2 / 2)) along the axis, indices matched",
     .parameters = {{"outer", 0.5, 0, 10, "absorption of the outer ball, 1 / radius"},
                    {"inner", 0, 0, 10, "absorption of the inner ball, 1 / outer radius"}},
     .points = {{{"outer", 0.5}}, {{"outer", 0}, {"inner", 0.5}}, {{"outer", 0.5}, {"inner", 0.25}}},
     .renderings = nested_absorbers,
     .known_limit = [](const Values& v, const VariantTraits&) -> std::string {
         return v["outer"] != 0 ? "media do not nest: a path that leaves the inner ball is taken to be in air, and the "
                                  "outer ball absorbs no more. Cure: a stack of media in the path"
                                : "";
     }},
});

}  // namespace
}  // namespace pt::stability::dielectrics_nested
