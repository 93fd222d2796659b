// Cases P1 to P9 of ptbench's own, for failures that cases S1 to S48 of docs/numerics.md lack.
#include <cmath>

#include "harness/scene/scene.h"
#include "kernels/materials/mix.h"
#include "kernels/rng.h"
#include "stability/cases/receiver.h"
#include "stability/oracles/limits.h"

namespace pt::stability::own {
namespace {

const Tolerance of_light{1e-5, 1e-12, "numerics.md S6 and S8"};

// A luminous ball that lies on the floor, lighting a point x radii from the contact.
std::vector<Rendering> touching_lamp(const Values& v) {
    const double x = v["x"];
    const double distance = std::sqrt(1 + x * x);
    const double gap = x < 1 ? x * x / (1 + std::sqrt(1 - x * x)) : 1;  // height of the ball's surface above the point
    SceneText scene("touching_lamp");
    scene.camera({x, 0.5 * gap, 0}, {x, 0, 0}, {0, 0, 1}).depth(2);
    scene.quad(scene.diffuse(Vec3d(receiver_albedo)), {x, 0, 0}, 8, 8);
    scene.sphere(scene.emitter(Vec3d(1.0)), {0, 1, 0}, 2);
    return lit(scene, pi<double> / (distance * distance * distance), of_light);
}

// The known limit of a light that covers nearly the whole hemisphere, so that few paths miss it.
std::string rarely_missed(const VariantTraits& variant, double irradiance) {
    return !variant.direct_light.connects ? too_rare(1 - irradiance / pi<double>) : "";
}

std::vector<Rendering> near_quad(const Values& v) {
    const double h = std::pow(10.0, v["log10_h"]);
    SceneText scene("near_quad");
    scene.camera({0, 0.5 * h, 0}, {0, 0, 0}, {0, 0, 1}).depth(2);
    scene.quad(scene.diffuse(Vec3d(receiver_albedo)), {0, 0, 0}, 8, 8);
    scene.quad(scene.emitter(Vec3d(1.0)), {0, h, 0}, 2, 2, {180, 0, 0});
    return lit(scene, 4 * rectangle_irradiance(1, 1, h), of_light);
}

// A ray that rises by `slope` per unit of length is reflected between mirrors at y = -1/2 and 1/2 until it hits the
// light at the end; the corridor's length puts the hit half way between two reflections.
Json corridor_scene(const Values& v) {
    const double slope = v["slope"], length = v["bounces"] / slope;
    const Vec3d turn(0, 0, v["turn"]);
    const Rotation rotation = rotation_of(turn);
    SceneText scene("corridor");
    scene.camera({0, 0, 0}, rotation.column[0] + rotation.column[1] * slope, rotation.column[2])
        .depth(v.whole("bounces") + v.whole("bounces") / 8 + 1);  // extra depth: rounding errors delay some paths
    const std::string mirror = scene.mirror(Vec3d(1 - std::exp2(-v["k"])));
    const Vec3d middle = rotation.column[0] * (0.5 * length);
    scene.quad(mirror, middle + rotation.column[1] * 0.5, length + 2, 4, turn);
    scene.quad(mirror, middle - rotation.column[1] * 0.5, length + 2, 4, turn);
    scene.box(scene.emitter(Vec3d(1.0)), rotation.column[0] * (length + 0.25), {0.5, 0.9375, 4}, turn);
    return scene.json();
}

std::vector<Rendering> corridor(const Values& v) {
    const double exact = std::exp(v["bounces"] * std::log1p(-std::exp2(-v["k"])));
    const double quantum = half_quantum(1);
    return {{.scene = corridor_scene(v),
             .quick_paths = 64,
             .full_paths = 1024,
             .quantities = {
                 every_pixel_is("radiance after the mirrors", exact,
                                {v["bounces"] * 0x1p-24 * exact + quantum, v["bounces"] * 0x1p-53 * exact + quantum,
                                 "a rounding of the throughput a bounce, and half the film's quantum"})}}};
}

std::string limit_of_mirrors(const Values& v, const VariantTraits& variant) {
    // How far, in reflections, a path may go astray by rounding errors of the mirrors' positions and its direction.
    const double astray = 0x1p-23 * v["bounces"] * (0.5 * v["bounces"] / v["slope"] + v["slope"]);
    return !variant.precision.is_double() && astray > 0.25
               ? "the roundings of the mirrors' places and of the direction add up to half a bounce; cure: "
                 "precision=double"
               : "";
}

std::vector<Rendering> long_ellipsoid(const Values& v) {
    const double emission = std::exp2(-5.0);
    SceneText scene("long_ellipsoid");
    scene.camera({0.25, 0.125, -0.125}, {1, 0.5, 1}).image(8, 8, 90, true).depth(64);
    scene.ellipsoid(scene.diffuse(Vec3d(1 - emission), Vec3d(emission)), {0, 0, 0},
                    v.is_set("flat") ? Vec3d(v["ratio"], 1, v["ratio"]) : Vec3d(v["ratio"], 1, 1), {20, 30, 40});
    return {furnace_rendering(scene, emission, 1 - emission, 64)};
}

// A room of six thin slabs with overlapping ends, rotated as a whole.
std::vector<Rendering> thin_walls(const Values& v) {
    const double emission = std::exp2(-7.0), thickness = v["thickness"];
    const Vec3d turn(v["turn"], 1.25 * v["turn"], 1.5 * v["turn"]), half(1, 1.5, 2);
    const Rotation rotation = rotation_of(turn);
    SceneText scene("thin_walls");
    scene.camera({0.25, 0.5, -0.125}, {0.5, -0.25, 1}).image(8, 8, 90, true).depth(256);
    const std::string wall = scene.diffuse(Vec3d(1 - emission), Vec3d(emission));
    for (int axis = 0; axis < 3; ++axis) {
        Vec3d size = half * 2.0 + Vec3d(2 * thickness);
        size[axis] = thickness;
        for (const double side : {-1.0, 1.0}) {
            scene.box(wall, rotation.column[axis] * (side * (half[axis] + 0.5 * thickness)), size, turn);
        }
    }
    return {furnace_rendering(scene, emission, 1 - emission, 256)};
}

std::string limit_of_walls(const Values& v, const VariantTraits& variant) {
    if (variant.precision.is_double()) {
        return "";
    }
    if (v["thickness"] < 0x1p-18) {
        return "walls thinner than 16 roundings of the room's size: points near an edge are rounded past the "
               "neighbouring wall; cure: precision=double";
    }
    return variant.precision.is_mixed() && std::fmod(v["turn"], 90) != 0
               ? "a point that was found in double ends in single precision off the turned wall that it lies on, by a "
                 "rounding that the next intersection sees: one of some 1e7 rays leaves; cure: precision=double"
               : "";
}

// An image whose left half sees a bright wall and whose right half a dim one.
std::vector<Rendering> contrast(const Values& v) {
    const double bright = std::pow(10.0, v["log10_bright"]), dim = std::pow(10.0, v["log10_dim"]);
    SceneText scene("contrast");
    scene.image(2, 1, 90, false);
    scene.quad(scene.emitter(Vec3d(bright)), {2, 0, 1}, 4, 8, {90, 0, 0});  // +x is on the left of the camera's image
    scene.quad(scene.emitter(Vec3d(dim)), {-2, 0, 1}, 4, 8, {90, 0, 0});
    Rendering rendering{.scene = scene.json(), .quick_paths = 1024, .full_paths = 65536, .quantities = {}};
    const double radiances[] = {bright, dim};
    const char* const names[] = {"radiance of the bright pixel", "radiance of the dim pixel"};
    for (std::uint32_t pixel = 0; pixel < 2; ++pixel) {
        const double exact = radiances[pixel];
        rendering.quantities.push_back(exactly(
            names[pixel], [pixel](const RenderResult& r) { return r.film.pixel(pixel).x; }, exact,
            Tolerance::relative(exact, 1e-6, 1e-12, "numerics.md S1")));
    }
    return {rendering};
}

std::string limit_of_contrast(const Values& v, const VariantTraits& variant) {
    const double ratio = half_quantum(1) * std::pow(10.0, v["log10_bright"] - v["log10_dim"]);
    return ratio > (variant.precision.is_double() ? 1e-13 : 1e-7)
               ? "the film's quantum is 2^-40 of the brightest light or so: what is darker is rounded away; cure: two "
                 "words a sum, or rounding by a random number of the sample's own"
               : "";
}

// A furnace whose paths are ended only by Russian roulette, after 1024 reflections on average.
std::vector<Rendering> long_roulette(const Values& v) {
    const double emission = std::exp2(-v["k"]);
    const double exact = furnace(emission, 1 - emission, v["depth"]);
    SceneText scene("long_roulette");
    scene.camera({0.25, 0.5, -0.125}, {0.5, -0.25, 1}).image(1, 1, 90, true).depth(v.whole("depth"));
    scene.sphere(scene.diffuse(Vec3d(1 - emission), Vec3d(emission)), {0, 0, 0}, 2);
    return {{.scene = scene.json(),
             .quick_paths = paths_for(1e6, v["depth"]),
             .full_paths = paths_for(6e7, v["depth"]),
             .quantities = {mean_is("mean radiance", exact, furnace_tolerance(emission, 1 - emission, v["depth"]))}}};
}

std::string limit_of_roulette(const Values& v, const VariantTraits& variant) {
    const double emission = std::exp2(-v["k"]);
    return !variant.russian_roulette.ends_paths ? lost_tail(emission, 1 - emission, v["depth"], variant) : "";
}

// A moving box that passes the axis half a second after the shutter opens, a long time after time 0.
std::vector<Rendering> late_shutter(const Values& v) {
    constexpr double speed = 8, width = 2;
    SceneText scene("late_shutter");
    scene.shutter(v["open"], v["open"] + 1, false);
    scene.box(scene.emitter(Vec3d(1.0)), {-0.5 * width - speed * (v["open"] + 0.5), 0, 5}, {width, 1, 1})
        .velocity({speed, 0, 0});
    return {
        {.scene = scene.json(),
         .quick_paths = 1u << 20,
         .full_paths = 1u << 25,
         .quantities = {mean_is("share of the second in which the box is seen", width / speed,
                                {0x1p-23 + 0x1p-22, 0x1p-31 + 0x1p-51 * (v["open"] + 1),
                                 "the steps of the random numbers, and the roundings of a time within a second"})}}};
}

std::string limit_of_time(const Values& v, const VariantTraits& variant) {
    return v["open"] != 0 && !variant.precision.is_double()
               ? "times are counted from 0, not from the shutter's opening, and objects are placed at time 0: a late "
                 "second has few moments left in single precision; cure: objects moved to the opening in double at load"
               : "";
}

// The share of random numbers that choose the mirror, by bisection of all 2^32 words: chooses_mirror is monotonic.
template <class Real>
double realised_probability(double probability) {
    std::uint64_t low = 0, high = std::uint64_t{1} << 32;
    while (low < high) {
        const std::uint64_t middle = (low + high) / 2;
        if (chooses_mirror(unit_interval<Real>(static_cast<std::uint32_t>(middle)), static_cast<Real>(probability))) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return static_cast<double>(low) * 0x1p-32;
}

std::vector<Measurement> rare_lobe(const Values& v, const DirectSetting& setting) {
    const double probability = std::exp2(-v["k"]);
    const double measured = setting.precision.is_double() ? realised_probability<double>(probability)
                                                          : realised_probability<float>(probability);
    return {{.quantity = "probability with which the lobe is chosen",
             .measured = measured,
             .exact = probability,
             .tolerance = {0, 0, "a power of two, of no less than one step of the random numbers"}}};
}

std::string limit_of_lobes(const Values& v, const VariantTraits& variant) {
    return v["k"] > (variant.precision.is_double() ? 32 : 24)
               ? "a random number has 24 bits in single precision and 32 in double: what is less probable than one of "
                 "them is chosen once in them; cure: compare the word's 32 bits, or two words"
               : "";
}

const CasesOf<Family::own> cases({
    {.name = "touching_lamp",
     .catalogue = "P1",
     .title = "a ball of light that lies on the floor",
     .stiff = "a receiver 5e-7 radii below a light that touches its surface: the light's cone is the whole hemisphere",
     .formula = "E = pi R^3 / d^3: the ball's lowest point is on the horizon",
     .parameters = {{"x", 0.1, 1e-3, 100, "of the receiver from the point of contact, in radii"}},
     .points = along("x", {1, 0.1, 0.01, 0.001}),
     .quick_points = along("x", {0.1, 0.001}),
     .sweep = "x",
     .estimators = {{axes::direct_light, {"nee", "nee_mis"}}},
     .renderings = touching_lamp,
     .known_limit =
         [](const Values& v, const VariantTraits& variant) {
             return rarely_missed(variant, pi<double> * std::pow(1 + v["x"] * v["x"], -1.5));
         }},
    {.name = "near_quad",
     .catalogue = "P2",
     .title = "a square of light right above the floor",
     .stiff = "a square 1e-6 of its side away: its solid angle is nearly 2 pi, and half of its directions graze",
     .formula = "four rectangles of S6",
     .parameters = {{"log10_h", -6, -15, 3, "of the height, scene units; the square's side is 2"}},
     .points = along("log10_h", {0, -3, -6, -9, -12}),
     .quick_points = along("log10_h", {-6, -12}),
     .sweep = "log10_h",
     .estimators = {{axes::direct_light, {"nee", "nee_mis"}}},
     .renderings = near_quad,
     .known_limit =
         [](const Values& v, const VariantTraits& variant) {
             return rarely_missed(variant, 4 * rectangle_irradiance(1, 1, std::pow(10.0, v["log10_h"])));
         }},
    {.name = "corridor",
     .catalogue = "P3",
     .title = "a light at the end of a corridor of two mirrors",
     .stiff = "1e4 reflections of one ray: a slope that is wrong by 5e-5 gets there a bounce too late",
     .formula = "rho^n after n bounces, rho = 1 - 2^-k",
     .parameters = {{"bounces", 1000, 1, 100000, "in the mirrors", true},
                    {"slope", 64, 0.01, 1e4, "of the ray, gaps between the mirrors a scene unit"},
                    {"turn", 0, -360, 360, "of the corridor, degrees"},
                    {"k", 13, 1, 24, "reflectance 1 - 2^-k", true}},
     .points = joined({along("bounces", {100, 10000}),
                       table({"bounces", "turn"}, {{100, 30}, {1000, 30}, {10000, 30}})}),
     .quick_points = {{{"bounces", 10000}}, {{"bounces", 100}, {"turn", 30}}},
     .sweep = "bounces",
     .renderings = corridor,
     .known_limit = limit_of_mirrors},
    {.name = "long_ellipsoid",
     .catalogue = "P4",
     .title = "a glowing ellipsoid of 1 to 1e4 from within",
     .stiff = "chords along a needle or a pancake: in the unit sphere's frame directions differ by 1e4 in length",
     .formula = "E (1 - rho^D) / (1 - rho), E = 2^-5",
     .parameters = {{"ratio", 1e4, 1, 1e9, "of the axes"}, {"flat", 0, 0, 1, "0: a needle, 1: a pancake", true}},
     .points = joined({along("ratio", {100, 1e4, 1e6}), table({"ratio", "flat"}, {{1e4, 1}, {1e6, 1}})}),
     .quick_points = {{{"ratio", 1e4}}, {{"ratio", 1e4}, {"flat", 1}}},
     .sweep = "ratio",
     .renderings = long_ellipsoid},
    {.name = "thin_walls",
     .catalogue = "P5",
     .title = "a room of six thin boxes, turned",
     .stiff = "walls of 1e-6 of their size that overlap at their ends: a ray that starts on one is inside another",
     .formula = "E (1 - rho^D) / (1 - rho), E = 2^-7",
     .parameters = {{"thickness", 1e-3, 1e-9, 1, "of the walls, scene units; the room is 2 x 3 x 4"},
                    {"turn", 20, -360, 360, "of the room, degrees about x"}},
     .points = joined({along("thickness", {0.1, 1e-3, 1e-6}), table({"thickness", "turn"}, {{1e-3, 0}, {1e-6, 0}})}),
     .quick_points = {{{"thickness", 1e-3}}, {{"thickness", 1e-3}, {"turn", 0}}},
     .sweep = "thickness",
     .renderings = thin_walls,
     .known_limit = limit_of_walls},
    {.name = "contrast",
     .catalogue = "P6",
     .title = "two radiances in one film",
     .stiff = "60 powers of ten between the brightest and the darkest pixel, in sums of 64 bits",
     .formula = "the radiances themselves",
     .parameters = {{"log10_bright", 0, -30, 30, "of the bright pixel's radiance"},
                    {"log10_dim", -3, -30, 30, "of the dim pixel's radiance; not above"}},
     .points = joined({along("log10_dim", {-3, -6, -9, -12}),
                       table({"log10_bright", "log10_dim"}, {{30, 27}, {-27, -30}, {30, -30}})}),
     .quick_points = {{{"log10_dim", -3}}, {{"log10_bright", 30}, {"log10_dim", -30}}},
     .sweep = "log10_dim",
     .renderings = contrast,
     .known_limit = limit_of_contrast},
    {.name = "long_roulette",
     .catalogue = "P7",
     .title = "a roulette of 1023 to 1024",
     .stiff = "a path survives with a probability of 1 - 2^-10 at every one of a thousand bounces",
     .formula = "E (1 - rho^D) / (1 - rho), E = 2^-k, whatever ends the paths",
     .parameters = {{"k", 10, 1, 20, "emission 2^-k, albedo 1 - 2^-k", true},
                    {"depth", 2048, 1, 1000000, "ray segments of a path", true}},
     .points = table({"k", "depth"}, {{3, 128}, {10, 2048}, {10, 16384}}),
     .quick_points = {{{"k", 10}, {"depth", 2048}}},
     .sweep = "depth",
     .estimators = {{axes::russian_roulette, {"throughput"}}},
     .renderings = long_roulette,
     .known_limit = limit_of_roulette},
    {.name = "late_shutter",
     .catalogue = "P8",
     .title = "a box that passes at a late time",
     .stiff = "in single precision a second has 16 moments left after 1e6 seconds, and none after 1e8",
     .formula = "width / speed",
     .parameters = {{"open", 1e6, 0, 1e8, "when the shutter opens, seconds"}},
     .points = along("open", {0, 1, 1000, 1e6, 1e8}),
     .quick_points = along("open", {0, 1e6}),
     .sweep = "open",
     .renderings = late_shutter,
     .known_limit = limit_of_time},
    {.name = "rare_lobe",
     .catalogue = "P9",
     .title = "a mirror that is chosen once in 2^k times",
     .stiff = "u < p with a random number of 24 bits: below 2^-24 every probability is that of one number",
     .formula = "2^-k",
     .parameters = {{"k", 23, 0, 40, "mirror probability 2^-k"}},
     .points = along("k", {0, 10, 23, 24, 28, 32, 36}),
     .quick_points = along("k", {23, 28}),
     .sweep = "k",
     .direct = rare_lobe,
     .known_limit = limit_of_lobes},
});

}  // namespace
}  // namespace pt::stability::own
