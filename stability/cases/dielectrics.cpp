// Cases S24 to S27: plates and balls of glass, rendered.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "stability/cases/glass.h"
#include "stability/oracles/limits.h"

namespace pt::stability::dielectrics {
namespace {

struct Pile {
    int plates = 1;
    double excess = 0.5;  // refractive index of the glass plates minus 1
    double thickness = 0.125, gap = 0.125, cosine = 1;
    double tau = 0;  // optical depth of absorption of a plate along its normal
};

// A path depth that at most a share e^-50 of the paths would exceed.
std::uint32_t enough_segments(int plates, long double reflected) {
    const double kept = static_cast<double>(1 - reflected);
    return static_cast<std::uint32_t>(std::min(64.0 * plates * plates * (1 + 1 / std::max(kept, 1e-9)), 1e6));
}

Rendering pile_of_plates(const Pile& pile, std::uint64_t paths) {
    SceneText scene("plates");
    const double sine = std::sqrt((1 - pile.cosine) * (1 + pile.cosine));
    scene.camera({0, 0, 0}, {0, sine, pile.cosine}, {1, 0, 0});
    const std::string glass = scene.dielectric(1 + pile.excess, Vec3d(pile.tau / pile.thickness));
    const double period = pile.thickness + pile.gap, end = 1 + pile.plates * period;
    for (int i = 0; i < pile.plates; ++i) {
        scene.box(glass, {0, 0, 1 + i * period + pile.thickness / 2}, {1e9, 1e9, pile.thickness});
    }
    scene.quad(scene.emitter(lamp_behind), {0, 0, end + 1}, 1e10, 1e10, {90, 0, 0});
    scene.quad(scene.emitter(lamp_before), {0, 0, -1}, 1e10, 1e10, {90, 0, 0});
    const long double excess = (1.0 + pile.excess) - 1.0;  // refractive index - 1, rounded as in the scene file
    const long double reflected = reflectance(excess, pile.cosine);
    scene.depth(enough_segments(pile.plates, reflected));
    const long double within =
        reflected < 1 && pile.tau > 0 ? std::exp(-pile.tau / cosine_beyond(excess, pile.cosine)) : 1;
    const Shares exact = stack_of(pile.plates, plate(reflected, within));
    // Both faces of a plate are rounded to single precision, which changes the thickness of the plate.
    const double thickness_rounding = pile.tau * pile.plates * end * 0x1p-23 / pile.thickness;
    Rendering rendering{.scene = scene.json(),
                        .quick_paths = paths,
                        .full_paths = 64 * paths,
                        .quantities = shares(exact, paths, thickness_rounding)};
    if (pile.tau == 0) {
        rendering.quantities.push_back(nothing_lost("transmitted and reflected"));
    }
    return rendering;
}

std::vector<Rendering> plates(const Values& v) {
    return {pile_of_plates({.plates = static_cast<int>(v["plates"]),
                            .excess = v["ior"] - 1,
                            .thickness = v["thickness"],
                            .gap = v["gap"],
                            .cosine = std::cos(v["degrees"] * std::numbers::pi / 180),
                            .tau = v["tau"]},
                           v["plates"] > 8 ? 1u << 14 : 1u << 15)};
}

std::vector<Rendering> nearly_no_plate(const Values& v) {
    return {pile_of_plates({.excess = v["excess"], .cosine = v["cosine"]}, 1u << 16)};
}

// An environment of radiance 1 and one camera ray that misses the centre of a unit ball, to be added, by `impact`.
SceneText ball(double impact, std::uint32_t depth) {
    SceneText scene("ball");
    scene.camera({impact, 0, -4}, {impact, 0, 0}).depth(depth).environment(1);
    return scene;
}

long double cosine_at(double impact) {
    return std::sqrt((1 - static_cast<long double>(impact)) * (1 + static_cast<long double>(impact)));
}

std::vector<Rendering> glass_body(const Values& v) {
    SceneText scene("glass_body");
    scene.camera({0, 0, -3}, {0, 0, 0}).image(16, 16, 50, true).depth(without_end).environment(1);
    add_body(scene, v.whole("shape"), scene.dielectric(v["ior"]));
    return {{.scene = scaled(scene.json(), v["size"]),
             .quick_paths = 1u << 14,
             .full_paths = 1u << 22,
             .quantities = {all_one("radiance of the pixel that is farthest off")}}};
}

std::vector<Rendering> cut_off(const Values& v) {
    const std::uint32_t hits = v.whole("hits");
    SceneText scene = ball(v["impact"], hits + 2);
    scene.sphere(scene.dielectric(v["ior"]), {0, 0, 0}, 2);
    const long double r = reflectance(static_cast<long double>(v["ior"]) - 1, cosine_at(v["impact"]));
    const long double lost = (1 - r) * std::pow(r, static_cast<long double>(hits));
    const std::uint64_t paths = 1u << 16;
    // Tolerance: rounding of the ray's impact parameter, times the derivative of the ball's reflectance by it.
    const double slope = static_cast<double>(v["impact"] / cosine_at(v["impact"])) * 4 * 0x1p-22;
    return {{.scene = scene.json(),
             .quick_paths = paths,
             .full_paths = 1u << 23,
             .quantities = {mean_is("radiance", static_cast<double>(1 - lost), chance_tolerance(lost, paths, slope))}}};
}

std::vector<Rendering> absorbing_ball(const Values& v) {
    SceneText scene = ball(v["impact"], without_end);
    scene.sphere(scene.dielectric(v["ior"], Vec3d(v["sigma"])), {0, 0, 0}, 2);
    const long double excess = static_cast<long double>(v["ior"]) - 1;
    const long double cosine = cosine_at(v["impact"]);
    const long double r = reflectance(excess, cosine);
    long double exact = 1;
    if (r < 1) {
        const long double a = std::exp(-2 * v["sigma"] * cosine_beyond(excess, cosine));
        exact = r + (1 - r) * (1 - r) * a / (1 - r * a);
    }
    const std::uint64_t paths = 1u << 16;
    const double slope = static_cast<double>(v["impact"] / cosine) * 4 * 0x1p-22;
    return {{.scene = scene.json(),
             .quick_paths = paths,
             .full_paths = 1u << 23,
             .quantities = {mean_is("radiance", static_cast<double>(exact), chance_tolerance(exact, paths, slope))}}};
}

// A path that meets the ball has 3 segments on average, for any index: 2 if reflected, with probability R, else 1
// before, 1 / (1 - R) inside and 1 after the ball. Under total reflection it has 2.
std::vector<Rendering> extreme_index(const Values& v) {
    SceneText scene = ball(v["impact"], without_end);
    scene.sphere(scene.dielectric(v["ior"]), {0, 0, 0}, 2);
    const long double excess = static_cast<long double>(v["ior"]) - 1;
    const long double r = reflectance(excess, cosine_at(v["impact"]));
    const double mean = r < 1 ? 3 : 2;
    // A random number of 24 bits realises the probability R to 2^-24, so 1 / (1 - R) is off by 2^-24 / (1 - R).
    const double step = r < 1 ? static_cast<double>(1 / (1 - r)) : 0;
    Rendering round{.scene = scene.json(),
                    .quick_paths = 1u << 16,
                    .full_paths = 1u << 23,
                    .quantities = {all_one("radiance"),
                                   {.name = "segments of a path",
                                    .of =
                                        [](const RenderResult& result) {
                                            return static_cast<double>(result.work.rays) /
                                                   static_cast<double>(result.work.paths);
                                        },
                                    .exact = mean,
                                    .tolerance = {1e-6 + 0x1p-21 * step, 1e-8 + 0x1p-29 * step,
                                                  "reflectance rounded, and met in steps of 2^-24 (2^-32 in double), "
                                                  "over the share that leaves at each hit"}}}};
    return {round, pile_of_plates({.excess = v["ior"] - 1}, 1u << 16)};
}

const CasesOf<Family::dielectrics> cases({
    {.name = "plates",
     .catalogue = "S24",
     .title = "light through a pile of plates",
     .stiff = "faces and gaps closer than any fixed epsilon, and at 89 degrees a reflectance that hangs on 1 - cos^2",
     .formula = "Stokes' pile without coherence: T = (1-R) / (1 + (2N-1) R); with absorption by adding layers. R: the "
                "unpolarised reflectance at every face, as tracers without polarisation have it",
     .parameters = {{"ior", 1.5, 0.1, 1e4, "of the plates"},
                    {"plates", 1, 1, 64, "how many", true},
                    {"thickness", 0.125, 1e-12, 1e3, "of a plate, scene units; the first stands at distance 1"},
                    {"gap", 0.125, 0x1p-16, 1e3, "between plates, scene units; single precision has to resolve it"},
                    {"degrees", 0, 0, 89.99, "angle of incidence"},
                    {"tau", 0, 0, 20, "absorption along the normal through one plate"}},
     .points = {{{"plates", 1}},
                {{"plates", 4}},
                {{"plates", 16}},
                {{"plates", 8}, {"ior", 2.4}},
                {{"plates", 4}, {"thickness", 0x1p-17}},
                {{"plates", 4}, {"thickness", 0x1p-20}},
                {{"plates", 4}, {"thickness", 0x1p-17}, {"gap", 0x1p-16}},
                {{"plates", 4}, {"thickness", 1e-9}},
                {{"degrees", 30}},
                {{"degrees", 60}},
                {{"degrees", 80}},
                {{"degrees", 89}},
                {{"degrees", 60}, {"plates", 4}, {"thickness", 0x1p-20}},
                {{"tau", 0.3}},
                {{"tau", 0.3}, {"degrees", 60}, {"plates", 4}}},
     .quick_points = {{{"plates", 4}, {"thickness", 0x1p-20}},
                      {{"degrees", 89}},
                      {{"tau", 0.3}, {"degrees", 60}, {"plates", 4}}},
     .sweep = "thickness",
     .renderings = plates},
    {.name = "glass_body",
     .catalogue = "S25",
     .title = "clear glass in even surroundings",
     .stiff = "internal reflections have no bound; one lost path, one refraction to the wrong side, or one factor of "
              "n^2 shows as a dark pixel",
     .formula = "1: nothing is absorbed, so every path leaves with weight 1 into radiance 1",
     .parameters = {{"shape", 0, 0, 3, "0 sphere, 1 ellipsoid, 2 box, 3 turned box", true},
                    {"ior", 1.5, 0.5, 2.5, "of the body; higher ones keep paths in an ellipsoid for too long"},
                    {"size", 1, 1e-6, 1e6, "factor on every length"}},
     .points = joined({along("shape", {0, 1, 2, 3}), table({"shape", "ior"}, {{0, 0.5}, {3, 2.4}}),
                       table({"shape", "size"}, {{0, 1e-6}, {3, 1e6}})}),
     .quick_points = {{{"shape", 0}}, {{"shape", 3}, {"ior", 2.4}}},
     .renderings = glass_body},
    {.name = "glass_cut_off",
     .catalogue = "S25",
     .title = "a glass ball whose internal reflections are cut off",
     .stiff = "what the depth cuts off is known to the path: a cap that is off by one, or a total reflection that is "
              "lost, changes the number",
     .formula = "1 - (1-R) R^k: R is the same at every internal hit, k of them are allowed",
     .parameters = {{"impact", 0.99, 0, 0.9999, "distance of the ray from the centre, over the radius"},
                    {"hits", 4, 0, 1000, "internal hits allowed; a path has two more segments", true},
                    {"ior", 1.5, 1.01, 1e4, "of the ball"}},
     .points = {{{"hits", 1}}, {{"hits", 2}}, {{"hits", 4}}, {{"hits", 8}}, {{"hits", 500}, {"ior", 1000}}},
     .quick_points = along("hits", {2, 8}),
     .sweep = "hits",
     .renderings = cut_off,
     .known_limit =
         [](const Values& v, const VariantTraits& variant) {
             return turns_inside(variant, v["impact"], v["ior"], v["hits"]);
         }},
    {.name = "absorbing_ball",
     .catalogue = "S25",
     .title = "an absorbing glass ball",
     .stiff = "a geometric series of internal reflections, each weighted by the chord",
     .formula = "R + (1-R)^2 a / (1 - R a), a = exp(-2 sigma r cos_t)",
     .parameters = {{"impact", 0.9, 0, 0.9999, "distance of the ray from the centre, over the radius"},
                    {"sigma", 0.7, 0, 20, "absorption, 1 / radius"},
                    {"ior", 1.5, 0.1, 1e4, "of the ball"}},
     .points = {{{"impact", 0.3}}, {{"impact", 0.9}}, {{"impact", 0.999}}, {{"impact", 0.3}, {"ior", 0.75}}},
     .quick_points = along("impact", {0.3, 0.999}),
     .sweep = "impact",
     .renderings = absorbing_ball},
    {.name = "nearly_no_plate",
     .catalogue = "S26",
     .title = "a grazing plate of an index of nearly 1",
     .stiff = "1 - cos^2 rounds to 1 at grazing angles, which makes a mirror of a plate that is not there",
     .formula = "T = (1-R) / (1+R), R from q^2 = c^2 + (n-1)(n+1); 1 for n = 1",
     .parameters = {{"excess", 0x1p-20, 0, 1, "index - 1"}, {"cosine", 1e-4, 1e-6, 1, "of incidence"}},
     .points = joined({along("excess", {0, 0x1p-10, 0x1p-20, 0x1p-23, 1e-6, 1e-9}),
                       table({"excess", "cosine"}, {{1e-9, 1e-2}})}),
     .quick_points = along("excess", {0, 0x1p-20}),
     .sweep = "excess",
     .renderings = nearly_no_plate},
    {.name = "extreme_index",
     .catalogue = "S27",
     .title = "balls and plates of an index of 1000, and bubbles",
     .stiff = "the few paths that enter reflect hundreds of times inside: variance grows as the index",
     .formula = "radiance 1; 3 segments a path on average, for 2 R + (1-R) (2 + 1 / (1-R)) = 3; T = (1-R) / (1+R)",
     .parameters = {{"ior", 1000, 0.1, 1e4, "of the body"},
                    {"impact", 0, 0, 0.9999, "distance of the ray from the centre, over the radius"}},
     .points = {{{"ior", 1000}},
                {{"ior", 1000}, {"impact", 0.9}},
                {{"ior", 100}},
                {{"ior", 1e4}},
                {{"ior", 0.75}, {"impact", 0.5}},
                {{"ior", 0.75}, {"impact", 0.9}}},
     .quick_points = {{{"ior", 1000}}, {{"ior", 0.75}, {"impact", 0.9}}},
     .sweep = "ior",
     .renderings = extreme_index,
     .known_limit =
         [](const Values& v, const VariantTraits& variant) {
             const long double r = reflectance(static_cast<long double>(v["ior"]) - 1, cosine_at(v["impact"]));
             return turns_inside(variant, v["impact"], v["ior"], r < 1 ? static_cast<double>(1 / (1 - r)) : 0);
         }},
});

}  // namespace
}  // namespace pt::stability::dielectrics
