// S24 to S28 and S30: glass, rendered. Lamps before and behind a pile have a colour each, so that one film tells what
// came back, what went through and, by the channel that both have, whether anything was lost.
#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include "harness/stability/case.h"
#include "harness/stability/oracles/fresnel.h"

namespace pt::stability {
namespace {

constexpr std::uint32_t without_end = 1000000;
const Vec3d lamp_behind(1, 0, 1), lamp_before(0, 1, 1);

// Where fewer than some hundred paths decide, batches do not tell their own spread: four standard errors from the
// binomial law, of the quick run.
double few_events(long double share, std::uint64_t paths) {
    const long double odd = std::min(std::abs(share), std::abs(1 - share));
    const bool is_few = odd * static_cast<long double>(paths) < 400;
    return is_few ? static_cast<double>(4 * std::sqrt(std::max(odd, 1e-18L) / static_cast<long double>(paths))) : 0;
}

// Of an estimate whose paths take one of two ways at boundaries.
Tolerance chance_tolerance(long double share, std::uint64_t paths, double more_single = 0) {
    const double few = few_events(share, paths);
    return {1e-6 + more_single + few, 1e-8 + few,
            "numerics.md S24: 1e-6 in single precision, for a reflectance is met in steps of 2^-24 (2^-32 in double); "
            "where few paths decide, 4 standard errors of the binomial law"};
}

Quantity nothing_lost(const std::string& name) {
    return {.name = name,
            .of = [](const RenderResult& result) { return mean_channel(result, 2); },
            .exact = 1,
            .tolerance = {0, 0, "every path ends in a lamp of radiance 1, with weight 1"},
            .is_estimate = false};
}

std::vector<Quantity> shares(const Shares& exact, std::uint64_t paths, double more_single = 0) {
    return {{.name = "transmitted",
             .of = [](const RenderResult& result) { return mean_channel(result, 0); },
             .exact = static_cast<double>(exact.transmitted),
             .tolerance = chance_tolerance(exact.transmitted, paths, more_single)},
            {.name = "reflected",
             .of = [](const RenderResult& result) { return mean_channel(result, 1); },
             .exact = static_cast<double>(exact.reflected),
             .tolerance = chance_tolerance(exact.reflected, paths, more_single)}};
}

struct Pile {
    int plates = 1;
    double excess = 0.5;  // index - 1
    double thickness = 0.125, gap = 0.125, cosine = 1;
    double tau = 0;  // absorption along the normal, a plate
};

// So many that e^-50 of the paths, or less, would have more.
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
    const long double excess = (1.0 + pile.excess) - 1.0;  // as the file has it
    const long double reflected = reflectance(excess, pile.cosine);
    scene.depth(enough_segments(pile.plates, reflected));
    const long double within =
        reflected < 1 && pile.tau > 0 ? std::exp(-pile.tau / cosine_beyond(excess, pile.cosine)) : 1;
    const Shares exact = stack_of(pile.plates, plate(reflected, within));
    // Both faces of a plate are rounded to single precision.
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

// A unit ball that a single ray meets at the distance b from its axis, in surroundings of radiance 1.
SceneText ball(double impact, std::uint32_t depth) {
    SceneText scene("ball");
    scene.camera({impact, 0, -4}, {impact, 0, 0}).depth(depth).environment(1);
    return scene;
}

long double cosine_at(double impact) {
    return std::sqrt((1 - static_cast<long double>(impact)) * (1 + static_cast<long double>(impact)));
}

Quantity all_one(const std::string& name) {
    return {.name = name,
            .of = farthest_from(1),
            .exact = 1,
            .tolerance = {0, 0, "every path leaves in the end, with weight 1"},
            .is_estimate = false};
}

std::vector<Rendering> glass_body(const Values& v) {
    SceneText scene("glass_body");
    scene.camera({0, 0, -3}, {0, 0, 0}).image(16, 16, 50, true).depth(without_end).environment(1);
    const std::string glass = scene.dielectric(v["ior"]);
    const double size = v["size"];
    switch (v.whole("shape")) {
        case 0:
            scene.sphere(glass, {0, 0, 0}, 2);
            break;
        case 1:
            scene.ellipsoid(glass, {0, 0, 0}, {2, 1, 1.5}, {10, 20, 30});
            break;
        case 2:
            scene.box(glass, {0, 0, 0}, {1.5, 1, 2});
            break;
        default:
            scene.box(glass, {0, 0, 0}, {1.5, 1, 2}, {10, 20, 30});
    }
    return {{.scene = scaled(scene.json(), size),
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
    // The reflectance's slope times the rounding of the impact.
    const double slope = static_cast<double>(v["impact"] / cosine_at(v["impact"])) * 4 * 0x1p-22;
    return {{.scene = scene.json(),
             .quick_paths = paths,
             .full_paths = 1u << 26,
             .quantities = {{.name = "radiance",
                             .of = mean_radiance,
                             .exact = static_cast<double>(1 - lost),
                             .tolerance = chance_tolerance(lost, paths, slope)}}}};
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
             .full_paths = 1u << 26,
             .quantities = {{.name = "radiance",
                             .of = mean_radiance,
                             .exact = static_cast<double>(exact),
                             .tolerance = chance_tolerance(exact, paths, slope)}}}};
}

// The mean of a path's segments is 3 whatever the index: 2 for the share R that is reflected, and for the share 1 - R
// that enters, 1 before, 1 / (1 - R) inside and 1 after. Under total reflection, 2.
std::vector<Rendering> extreme_index(const Values& v) {
    SceneText scene = ball(v["impact"], without_end);
    scene.sphere(scene.dielectric(v["ior"]), {0, 0, 0}, 2);
    const long double excess = static_cast<long double>(v["ior"]) - 1;
    const long double r = reflectance(excess, cosine_at(v["impact"]));
    const double mean = r < 1 ? 3 : 2;
    // A 24-bit number is below R in the share R to 2^-24: the 1 / (1 - R) inside is off by that over 1 - R.
    const double step = r < 1 ? static_cast<double>(1 / (1 - r)) : 0;
    Rendering round{.scene = scene.json(),
                    .quick_paths = 1u << 16,
                    .full_paths = 1u << 24,
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

std::vector<Rendering> light_pipe(const Values& v) {
    const double theta = v["theta"], azimuth = v["azimuth"], length = v["length"];
    const Vec3d direction(std::sin(theta) * std::cos(azimuth), std::sin(theta) * std::sin(azimuth), std::cos(theta));
    SceneText scene("light_pipe");
    scene.camera({0, 0, 0}, direction, {0, 1, 0}).depth(without_end);
    const Vec3d aim = direction * (1 / direction.z) - Vec3d(0.125, -0.25, 0);  // of the face's centre
    scene.box(scene.dielectric(v["ior"]), {aim.x, aim.y, 1 + length / 2}, {1, 1, length});
    scene.quad(scene.emitter(lamp_behind), {0, 0, length + 2}, 1e6, 1e6, {90, 0, 0});
    scene.quad(scene.emitter(lamp_before), {0, 0, -1}, 1e6, 1e6, {90, 0, 0});
    const Shares exact =
        plate(reflectance(static_cast<long double>(v["ior"]) - 1, std::cos(static_cast<long double>(theta))), 1);
    // A power of two, so that a mean over paths that all return 1 is 1.
    const std::uint64_t paths =
        std::bit_floor(static_cast<std::uint64_t>(std::clamp(1e6 / (length * std::tan(theta) + 4), 1024.0, 65536.0)));
    Rendering rendering{
        .scene = scene.json(), .quick_paths = paths, .full_paths = 64 * paths, .quantities = shares(exact, paths)};
    rendering.quantities.push_back(nothing_lost("what did not leak through the sides"));
    return {rendering};
}

// A ball with a ball in it. The inner material's index is that against the outer one, or against air.
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
        .scene = axis.json(), .quick_paths = paths, .full_paths = 1u << 24, .quantities = shares(exact, paths)};
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
             .quantities = {{.name = "radiance",
                             .of = farthest_from(exact),
                             .exact = exact,
                             .tolerance = {1e-6, 1e-12, "chords to some roundings of the distance 4, film's quantum"},
                             .is_estimate = false}}}};
}

const CaseRegistration cases({
    {.name = "plates",
     .catalogue = "S24",
     .family = "dielectrics",
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
     .family = "dielectrics",
     .title = "clear glass in even surroundings",
     .stiff = "internal reflections have no bound; one lost path, one refraction to the wrong side, or one factor of "
              "n^2 shows as a dark pixel",
     .formula = "1: nothing is absorbed, so every path leaves with weight 1 into radiance 1",
     .parameters = {{"shape", 0, 0, 3, "0 sphere, 1 ellipsoid, 2 box, 3 turned box", true},
                    {"ior", 1.5, 0.5, 2.5, "of the body; higher ones keep paths in an ellipsoid for too long"},
                    {"size", 1, 1e-6, 1e6, "factor on every length"}},
     .points = {{{"shape", 0}},
                {{"shape", 1}},
                {{"shape", 2}},
                {{"shape", 3}},
                {{"shape", 0}, {"ior", 0.5}},
                {{"shape", 3}, {"ior", 2.4}},
                {{"shape", 0}, {"size", 1e-6}},
                {{"shape", 3}, {"size", 1e6}}},
     .quick_points = {{{"shape", 0}}, {{"shape", 3}, {"ior", 2.4}}},
     .renderings = glass_body},
    {.name = "glass_cut_off",
     .catalogue = "S25",
     .family = "dielectrics",
     .title = "a glass ball whose internal reflections are cut off",
     .stiff = "what the depth cuts off is known to the path: a cap that is off by one, or a total reflection that is "
              "lost, changes the number",
     .formula = "1 - (1-R) R^k: R is the same at every internal hit, k of them are allowed",
     .parameters = {{"impact", 0.99, 0, 0.9999, "distance of the ray from the centre, over the radius"},
                    {"hits", 4, 0, 1000, "internal hits allowed; a path has two more segments", true},
                    {"ior", 1.5, 1.01, 1e4, "of the ball"}},
     .points = {{{"hits", 1}}, {{"hits", 2}}, {{"hits", 4}}, {{"hits", 8}}, {{"hits", 500}, {"ior", 1000}}},
     .quick_points = {{{"hits", 2}}, {{"hits", 8}}},
     .sweep = "hits",
     .renderings = cut_off},
    {.name = "absorbing_ball",
     .catalogue = "S25",
     .family = "dielectrics",
     .title = "an absorbing glass ball",
     .stiff = "a geometric series of internal reflections, each weighted by the chord",
     .formula = "R + (1-R)^2 a / (1 - R a), a = exp(-2 sigma r cos_t)",
     .parameters = {{"impact", 0.9, 0, 0.9999, "distance of the ray from the centre, over the radius"},
                    {"sigma", 0.7, 0, 20, "absorption, 1 / radius"},
                    {"ior", 1.5, 0.1, 1e4, "of the ball"}},
     .points = {{{"impact", 0.3}}, {{"impact", 0.9}}, {{"impact", 0.999}}, {{"impact", 0.3}, {"ior", 0.75}}},
     .quick_points = {{{"impact", 0.3}}, {{"impact", 0.999}}},
     .sweep = "impact",
     .renderings = absorbing_ball},
    {.name = "nearly_no_plate",
     .catalogue = "S26",
     .family = "dielectrics",
     .title = "a grazing plate of an index of nearly 1",
     .stiff = "1 - cos^2 rounds to 1 at grazing angles, which makes a mirror of a plate that is not there",
     .formula = "T = (1-R) / (1+R), R from q^2 = c^2 + (n-1)(n+1); 1 for n = 1",
     .parameters = {{"excess", 0x1p-20, 0, 1, "index - 1"}, {"cosine", 1e-4, 1e-6, 1, "of incidence"}},
     .points = {{{"excess", 0}},
                {{"excess", 0x1p-10}},
                {{"excess", 0x1p-20}},
                {{"excess", 0x1p-23}},
                {{"excess", 1e-6}},
                {{"excess", 1e-9}},
                {{"excess", 1e-9}, {"cosine", 1e-2}}},
     .quick_points = {{{"excess", 0}}, {{"excess", 0x1p-20}}},
     .sweep = "excess",
     .renderings = nearly_no_plate},
    {.name = "extreme_index",
     .catalogue = "S27",
     .family = "dielectrics",
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
     .renderings = extreme_index},
    {.name = "light_pipe",
     .catalogue = "S28",
     .family = "dielectrics",
     .title = "a glass rod that conducts light",
     .stiff = "thousands of total reflections off the sides, none of which may leak",
     .formula = "T = (1-R) / (1+R) of the two ends, whatever the length: beyond n^2 = 1 + sin^2 the sides reflect all",
     .parameters = {{"length", 50, 1, 1e5, "of the rod, in widths"},
                    {"theta", 0.9, 0.1, 1.5, "angle of incidence on the end, radians"},
                    {"azimuth", 0.7, 0, 6.28, "of the incident ray, radians"},
                    {"ior", 1.5, 1.415, 10, "of the rod, above sqrt(2)"}},
     .points = {{{"length", 1}}, {{"length", 50}}, {{"length", 1000}}, {{"length", 1000}, {"theta", 1.5}}},
     .quick_points = {{{"length", 1}}, {{"length", 1000}}},
     .sweep = "length",
     .renderings = light_pipe},
    {.name = "nested_balls",
     .catalogue = "S30",
     .family = "dielectrics",
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
     .known_limit = [](const Values& v, const Variant&) -> std::string {
         return v.is_set("against_air")
                    ? "media do not nest: every index is taken as that of the boundary, here of air "
                      "against the inner ball. Cure: give the inner ball the index inner / outer, "
                      "or a stack of media in the path"
                    : "";
     }},
    {.name = "nested_absorbers",
     .catalogue = "S30",
     .family = "dielectrics",
     .title = "an absorbing ball within an absorbing ball",
     .stiff = "on leaving the inner ball the path is in the outer one again",
     .formula = "exp(-(s_outer 2 (1 - 1/2) + s_inner 2 / 2)) along the axis, indices matched",
     .parameters = {{"outer", 0.5, 0, 10, "absorption of the outer ball, 1 / radius"},
                    {"inner", 0, 0, 10, "absorption of the inner ball, 1 / outer radius"}},
     .points = {{{"outer", 0.5}}, {{"outer", 0}, {"inner", 0.5}}, {{"outer", 0.5}, {"inner", 0.25}}},
     .renderings = nested_absorbers,
     .known_limit = [](const Values& v, const Variant&) -> std::string {
         return v["outer"] != 0 ? "media do not nest: a path that leaves the inner ball is taken to be in air, and the "
                                  "outer ball absorbs no more. Cure: a stack of media in the path"
                                : "";
     }},
});

}  // namespace
}  // namespace pt::stability
