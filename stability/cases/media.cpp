// Cases S32 to S37: absorbing and scattering bodies, rendered. A body of matched index in an environment of radiance 1
// shows its albedo; a lamp behind a slab with a colour channel of its own separates transmission from reflection.
#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include "stability/cases/glass.h"
#include "stability/oracles/transfer.h"

namespace pt::stability::media {
namespace {

constexpr double half_quantum = 0x1p-40;  // largest rounding error of a film with radiance 1 and 2^16 samples

std::vector<Rendering> absorbing_chord(const Values& v) {
    const double b = v["impact"], sigma = v["t"] / 2;
    SceneText scene("absorbing_chord");
    scene.camera({b, 0, -5}, {b, 0, 0}).depth(3).environment(1);
    scene.sphere(scene.dielectric(1, Vec3d(sigma)), {0, 0, 0}, 2);
    const double cosine = std::sqrt((1 - b) * (1 + b)), exact = std::exp(-v["t"] * cosine);
    // The error of a chord of the ball: some roundings of the eye's distance, 5 radii, magnified by 1 / cosine.
    const double roundings = 32 * (1 + 5 * sigma / cosine) * exact;
    return {{.scene = scene.json(),
             .quick_paths = 16,
             .full_paths = 1024,
             .quantities = {every_pixel_is("radiance", exact,
                                           {roundings * 0x1p-23 + half_quantum, roundings * 0x1p-52 + half_quantum,
                                            "32 roundings of the chord, 5 radii away and magnified by 1 / cos, and the "
                                            "film's quantum"})}}};
}

// A wide slab below the eye, with nothing but black behind. `mu`: cosine of incidence; with 0 the camera looks at a
// small white quad that faces the slab and scatters diffuse light onto it.
SceneText slab_scene(double depth, double albedo, double g, double mu, double sigma, std::uint32_t cap) {
    SceneText scene("slab");
    const double thickness = depth / sigma, above = 0.0625 / sigma, width = 1e5 * (1 + depth) / sigma;
    if (mu > 0) {
        scene.camera({0, 0, 0}, {0, -mu, std::sqrt((1 - mu) * (1 + mu))}, {1, 0, 0}).depth(2);
    } else {
        scene.camera({0, 0, 0}, {0, 1, 0}, {1, 0, 0}).depth(3);
        scene.quad(scene.diffuse(Vec3d(1.0)), {0, above / 16, 0}, 1e-9 / sigma, 1e-9 / sigma, {180, 0, 0});
    }
    scene.box(scene.subsurface(Vec3d(albedo * sigma), Vec3d((1 - albedo) * sigma), g, 1, cap),
              {0, -above - thickness / 2, 0}, {width, thickness, width});
    return scene;
}

// Adds a wide quad just below the slab, which hides the environment from light that leaves the slab downwards.
void add_below(SceneText& scene, const std::string& material, double depth, double sigma) {
    const double width = 4e5 * (1 + depth) / sigma;
    scene.quad(material, {0, -(depth * (1 + 0x1p-10) + 0.0625) / sigma, 0}, width, width);
}

// The number of paths is a power of two, so that the mean of paths that all return 1 is exactly 1.
std::uint64_t paths_for(double segments_per_path) {
    return std::bit_floor(static_cast<std::uint64_t>(std::clamp(1e6 / segments_per_path, 256.0, 65536.0)));
}

double albedo_of(const Values& v) { return 1 - std::exp2(-v["k"]); }

std::vector<Rendering> half_space(const Values& v) {
    const double w = albedo_of(v), mu = v["mu"];
    // The slab stands in for a half space: only a share e^-40 of the light would return from below.
    const double depth = 20 / std::sqrt(3 * (1 - w));
    const auto cap = static_cast<std::uint32_t>(std::min(1e9, std::max(1e6, 64 / (1 - w))));
    SceneText scene = slab_scene(depth, w, 0, mu, 1, cap);
    add_below(scene, scene.diffuse(Vec3d(0.0)), depth, 1);
    scene.environment(1);
    const HFunction h(w);
    const double exact = mu > 0 ? h.plane_albedo(mu) : h.diffuse_albedo();
    // The error of the throughput, in roundings: one for every collision.
    const double roundings = mean_collisions(w, mu) * exact;
    const std::uint64_t paths = paths_for(2 * depth);
    return {{.scene = scene.json(),
             .quick_paths = paths,
             .full_paths = 64 * paths,
             .quantities = {mean_is("albedo", exact,
                                    {1e-7 + roundings * 0x1p-24, 1e-9 + roundings * 0x1p-53,
                                     "a rounding of the throughput at each of d ln A / d ln w collisions, the "
                                     "absorption's and the free path's of 2^-24 (2^-32 in double)"})}}};
}

// A white half space that loses light scattered more than `cap` times: H(mu) / sqrt(pi n) for large n, from the branch
// point of 1 - sqrt(1-w) H at w = 1; the next term is smaller by a factor of n.
std::vector<Rendering> capped_half_space(const Values& v) {
    const double cap = v["cap"], mu = v["mu"];
    const double depth = 16 * std::sqrt(cap) + 100;
    SceneText scene = slab_scene(depth, 1, 0, mu, 1, v.whole("cap"));
    scene.environment(1);
    const double exact = HFunction(1).at(mu) / std::sqrt(std::numbers::pi * cap);
    const std::uint64_t paths = paths_for(4 * std::sqrt(cap));
    return {
        {.scene = scene.json(),
         .quick_paths = paths,
         .full_paths = 64 * paths,
         .quantities = {{.name = "unfinished walks a path",
                         .of =
                             [](const RenderResult& result) {
                                 return static_cast<double>(result.work.unfinished_walks) /
                                        static_cast<double>(result.work.paths);
                             },
                         .exact = exact,
                         .tolerance = {exact / cap, exact / cap, "the next term of the asymptotic series"}},
                        exactly("radiance and unfinished walks a path",
                                [](const RenderResult& result) {
                                    return mean_radiance(result) + static_cast<double>(result.work.unfinished_walks) /
                                                                       static_cast<double>(result.work.paths);
                                },
                                1, {half_quantum, half_quantum, "a path is counted or comes back with weight 1"})}}};
}

std::vector<Rendering> slab(const Values& v) {
    const double depth = v["tau"], w = v["albedo"], mu = v["mu"];
    SceneText scene = slab_scene(depth, w, 0, mu, v["sigma"], 1000000);
    add_below(scene, scene.emitter({1, 0, 0}), depth, v["sigma"]);
    scene.environment(1);
    const SlabShares exact = slab_shares(depth, w, mu);
    const std::uint64_t paths = paths_for(4 + 2 * depth);
    const double known = 8 * exact.error;
    const Tolerance tolerance{
        1e-6 + known, 1e-9 + known,
        "numerics.md S34: 4 SE; free paths and weights to 2^-24 (2^-32 in double); the oracle's own "
        "error"};
    std::vector<Quantity> quantities{
        {.name = "reflected",
         .of = [](const RenderResult& result) { return mean_channel(result, 1); },
         .exact = exact.reflected,
         .tolerance = tolerance},
        {.name = "transmitted",
         .of = [](const RenderResult& result) { return mean_channel(result, 0) - mean_channel(result, 1); },
         .exact = exact.transmitted,
         .tolerance = tolerance}};
    if (w == 1) {
        quantities.push_back(exactly("reflected and transmitted",
                                     [](const RenderResult& result) { return mean_channel(result, 0); }, 1,
                                     {0, 0, "every walk comes out, with weight 1"}));
    }
    return {{.scene = scene.json(), .quick_paths = paths, .full_paths = 64 * paths, .quantities = quantities}};
}

std::vector<Rendering> white_body(const Values& v) {
    SceneText scene("white_body");
    const double n = v["ior"];
    scene.camera({0, 0, -3}, {0, 0, 0}).image(8, 8, 40, true).depth(n == 1 ? 2 : 1000).environment(1);
    add_body(scene, v.whole("shape"), scene.subsurface(Vec3d(v["sigma"]), Vec3d(0.0), v["g"], n, v.whole("cap")));
    const std::uint64_t paths = paths_for(4 + 2 * n * n * v["sigma"]);
    return {{.scene = scaled(scene.json(), v["size"]),
             .quick_paths = paths,
             .full_paths = 16 * paths,
             .quantities = {every_pixel_is("radiance of the pixel that is farthest off", 1,
                                           {0, 0, "every path leaves in the end, with weight 1"})}}};
}

// A body that only absorbs, by random walks of a subsurface material; the exact answer is that of absorbing glass.
std::vector<Rendering> absorbing_body(const Values& v) {
    const double b = v["impact"];
    SceneText scene("absorbing_body");
    scene.camera({b, 0, -4}, {b, 0, 0}).depth(1000).environment(1);
    scene.sphere(scene.subsurface(Vec3d(0.0), Vec3d(v["sigma"]), 0, v["ior"]), {0, 0, 0}, 2);
    const long double excess = static_cast<long double>(v["ior"]) - 1;
    const long double cosine = std::sqrt((1 - static_cast<long double>(b)) * (1 + b));
    const long double r = reflectance(excess, cosine);
    const long double a = std::exp(-2 * v["sigma"] * cosine_beyond(excess, cosine));
    const double slope = static_cast<double>(b / cosine) * 4 * 0x1p-22 * (1 + v["sigma"]);
    return {{.scene = scene.json(),
             .quick_paths = 1u << 16,
             .full_paths = 1u << 23,
             .quantities = {mean_is("radiance", static_cast<double>(r + (1 - r) * (1 - r) * a / (1 - r * a)),
                                    {1e-6 + slope, 1e-8,
                                     "reflectances and free paths to 2^-24 (2^-32 in double), the chord's "
                                     "rounding"})}}};
}

std::vector<Twins> clear_twins(const Values& v) {
    const auto scene = [&](bool is_subsurface) {
        SceneText text("clear");
        text.camera({0, 0, -3}, {0, 0, 0}).image(16, 16, 50, true).depth(10000).environment(1);
        add_body(text, v.whole("shape"),
                 is_subsurface ? text.subsurface(Vec3d(0.0), Vec3d(0.0), 0, v["ior"]) : text.dielectric(v["ior"]));
        return text.json();
    };
    return {{.change = "a body without medium instead of glass", .reference = scene(false), .changed = scene(true)}};
}

// A ball that is opaque: if the free path is short against the radius, its surface reflects like a half space.
std::vector<Rendering> opaque_ball(const Values& v) {
    const double w = albedo_of(v), sigma = v["sigma"];
    SceneText scene("opaque_ball");
    scene.camera({0, 0, -v["distance"]}, {0, 0, 0}).depth(2).environment(1);
    // The cap on scatterings ends walks of weight e^-64; without a cap, a walk stuck by rounding would never end.
    const auto cap = static_cast<std::uint32_t>(64 / (1 - w));
    scene.sphere(scene.subsurface(Vec3d(w * sigma), Vec3d((1 - w) * sigma), 0, 1, cap), {0, 0, 0}, 2);
    const double exact = HFunction(w).plane_albedo(1);
    const double collisions = mean_collisions(w, 1);
    const std::uint64_t paths = paths_for(16 * collisions + 4);
    // A curved surface lets out more light than a plane, by a share of about the diffusion length over the radius.
    const double curvature = 4 / (sigma * std::sqrt(3 * (1 - w))) * exact * (1 - exact);
    return {{.scene = scene.json(),
             .quick_paths = paths,
             .full_paths = 64 * paths,
             .quantities = {mean_is("albedo", exact,
                                    {1e-6 + curvature, 1e-6 + curvature,
                                     "numerics.md S33, and the curvature: a diffusion length over the radius"})}}};
}

const CasesOf<Family::media> cases({
    {.name = "absorbing_chord",
     .catalogue = "S32",
     .title = "a ray through an absorbing ball of matched index",
     .stiff = "towards the limb the chord, a difference of two roots, vanishes; far away its digits do",
     .formula = "exp(-t sqrt(1 - b^2)), t = 2 sigma R (Beer and Lambert)",
     .parameters = {{"t", 1, 0, 30, "absorption along the diameter"},
                    {"impact", 0.5, 0, 0.9999, "distance of the ray from the centre, over the radius"}},
     .points = joined({along("t", {1e-3, 0.1, 1, 5, 20}), table({"t", "impact"}, {{1, 0}, {1, 0.999}})}),
     .quick_points = along("t", {1e-3, 20}),
     .sweep = "t",
     .renderings = absorbing_chord},
    {.name = "half_space",
     .catalogue = "S33",
     .title = "albedo of a scattering half space",
     .stiff = "some 1 / sqrt(1-w) scatterings on average, with a tail that falls as n^(-1/2) up to n = 1 / (1-w)",
     .formula =
         "1 - sqrt(1-w) H(mu), diffuse 1 - 2 sqrt(1-w) alpha_1; Chandrasekhar's H by iteration; w = 1 - 2^-k, in "
         "a slab from whose other face e^-40 returns",
     .parameters = {{"k", 3, 1, 20, "single scattering albedo 1 - 2^-k", true},
                    {"mu", 1, 0, 1, "cosine of incidence; 0: diffuse"}},
     .points =
         {{{"k", 1}}, {{"k", 3}}, {{"k", 3}, {"mu", 0.5}}, {{"k", 3}, {"mu", 0}}, {{"k", 7}}, {{"k", 10}}, {{"k", 13}}},
     .quick_points = {{{"k", 1}}, {{"k", 3}, {"mu", 0}}, {{"k", 7}}},
     .sweep = "k",
     .renderings = half_space},
    {.name = "capped_half_space",
     .catalogue = "S33",
     .title = "what a cap on scatterings loses of a white half space",
     .stiff = "the share that scatters more than n times falls as n^(-1/2) only, without end",
     .formula = "H(mu) / sqrt(pi n), from the branch point of Chandrasekhar's albedo at w = 1",
     .parameters = {{"cap", 1024, 64, 1e6, "scatterings allowed", true}, {"mu", 1, 0.01, 1, "cosine of incidence"}},
     .points = {{{"cap", 256}}, {{"cap", 1024}}, {{"cap", 4096}}, {{"cap", 4096}, {"mu", 0.5}}, {{"cap", 65536}}},
     .quick_points = {{{"cap", 256}}, {{"cap", 4096}, {"mu", 0.5}}},
     .sweep = "cap",
     .renderings = capped_half_space},
    {.name = "slab",
     .catalogue = "S34",
     .title = "reflectance and transmittance of a scattering slab",
     .stiff = "what goes through a thick slab has scattered tau^2 times",
     .formula = "the integral equation of the collision density by Galerkin's method (oracles/transfer.h)",
     .parameters = {{"tau", 2, 0.01, 20, "optical depth"},
                    {"albedo", 1, 0, 1, "of single scattering"},
                    {"mu", 1, 0, 1, "cosine of incidence; 0: diffuse"},
                    {"sigma", 1, 1e-6, 1e6, "attenuation, 1 / scene unit"}},
     .points = {{{"tau", 0.1}},
                {{"tau", 1}},
                {{"tau", 1}, {"mu", 0}},
                {{"tau", 2}},
                {{"tau", 2}, {"mu", 0}, {"albedo", 0.9}},
                {{"tau", 2}, {"mu", 0}, {"sigma", 1e6}},
                {{"tau", 5}, {"mu", 0.5}, {"albedo", 0.99}},
                {{"tau", 10}},
                {{"tau", 20}, {"mu", 0}}},
     .quick_points = {{{"tau", 1}, {"mu", 0}}, {{"tau", 2}, {"albedo", 0.9}}},
     .sweep = "tau",
     .renderings = slab},
    {.name = "white_body",
     .catalogue = "S36",
     .title = "a white scattering body in even surroundings",
     .stiff =
         "some n^2 sigma scatterings a path with a tail up to their square, none of which may leave, freeze or lose "
         "a rounding",
     .formula = "1: nothing is absorbed, so every path leaves with weight 1 into radiance 1",
     .parameters = {{"sigma", 10, 0, 1e6, "scattering, 1 / radius"},
                    {"shape", 0, 0, 3, "0 sphere, 1 ellipsoid, 2 box, 3 turned box", true},
                    {"ior", 1, 1, 2, "of the body"},
                    {"g", 0, -0.999, 0.999, "mean cosine of the phase function"},
                    {"size", 1, 1e-6, 1e6, "factor on every length"},
                    {"cap", 1e8, 1, 1e9,
                     "scatterings and internal reflections allowed; a cap below some 10 (sigma ior)^2 loses paths",
                     true}},
     .points = {{{"sigma", 1e-3}},
                {{"sigma", 1}},
                {{"sigma", 10}, {"shape", 1}, {"g", 0.9}},
                {{"sigma", 10}, {"shape", 2}, {"ior", 1.5}},
                {{"sigma", 10}, {"shape", 3}, {"ior", 1.5}, {"g", -0.5}},
                {{"sigma", 100}, {"ior", 1.5}},
                {{"sigma", 1000}},
                {{"sigma", 1e4}},
                {{"sigma", 10}, {"size", 1e-6}},
                {{"sigma", 10}, {"size", 1e6}, {"shape", 3}},
                {{"sigma", 10}, {"g", 0.999}}},
     .quick_points = {{{"sigma", 10}, {"shape", 3}, {"ior", 1.5}}, {{"sigma", 100}}, {{"sigma", 10}, {"size", 1e-6}}},
     .sweep = "sigma",
     .renderings = white_body},
    {.name = "clear_body",
     .catalogue = "S37",
     .title = "a scattering body without medium is glass",
     .stiff = "sigma = 0 has free paths of infinite length and an albedo of 0 / 0",
     .formula = "bit for bit the film of the dielectric with the same index: 1 everywhere",
     .parameters = {{"shape", 0, 0, 3, "0 sphere, 1 ellipsoid, 2 box, 3 turned box", true},
                    {"ior", 1.5, 1, 2, "of the body"}},
     .points = {{{"shape", 0}}, {{"shape", 1}}, {{"shape", 2}}, {{"shape", 3}}, {{"ior", 1}}},
     .quick_points = {{{"shape", 0}}, {{"ior", 1}}},
     .twins = clear_twins},
    {.name = "absorbing_body",
     .catalogue = "S37",
     .title = "a body that absorbs and does not scatter",
     .stiff = "every collision has the weight 0, so a walk tells e^-t by its rare ends alone",
     .formula = "R + (1-R)^2 a / (1 - R a), a = exp(-2 sigma r cos_t): the dielectric's",
     .parameters = {{"sigma", 0.7, 0, 3, "absorption, 1 / radius"},
                    {"impact", 0.6, 0, 0.999, "distance of the ray from the centre, over the radius"},
                    {"ior", 1.5, 1, 10, "of the body"}},
     .points = {{{"ior", 1}}, {{"ior", 1}, {"sigma", 2.5}}, {{"ior", 1.5}}, {{"ior", 1.5}, {"impact", 0.99}}},
     .quick_points = along("ior", {1, 1.5}),
     .sweep = "sigma",
     .renderings = absorbing_body},
    {.name = "opaque_ball",
     .catalogue = "S37",
     .title = "a ball with free paths of a millionth of its radius",
     .stiff = "free paths below the spacing of the numbers that hold positions",
     .formula = "Chandrasekhar's half space: 1 - sqrt(1-w) H(1), w = 1 - 2^-k",
     .parameters = {{"sigma", 1e4, 1e3, 1e12, "attenuation, 1 / radius"},
                    {"distance", 3, 1.01, 100, "of the eye from the centre, radii"},
                    {"k", 3, 1, 10, "single scattering albedo 1 - 2^-k", true}},
     .points = along("sigma", {1e4, 1e5, 1e6, 1e7, 1e8}),
     .quick_points = along("sigma", {1e4, 1e8}),
     .sweep = "sigma",
     .renderings = opaque_ball,
     .known_limit = [](const Values& v, const VariantTraits& variant) -> std::string {
         const double spacing = variant.precision.is_double() ? 0x1p-53 : 0x1p-24;
         return v["sigma"] * (v["distance"] - 1) * spacing > 0x1p-6
                    ? "walks hold positions relative to the eye: a free path of less than some 100 spacings of numbers "
                      "there is rounded, to none at all in the end. Cure: hold them relative to where the walk began"
                    : "";
     }},
});

}  // namespace
}  // namespace pt::stability::media
