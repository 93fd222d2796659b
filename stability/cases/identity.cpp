// Cases S11, S12 and the metamorphic list of numerics.md 4.1: changes that must not change an image, bit for bit.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "harness/stability/case.h"

namespace pt::stability::identity {
namespace {

// A scene with every shape, every material, several lights, lens, shutter and jitter. Positions are multiples of 2^-6,
// so that shifts by multiples of 2^-6 are exact.
Json menagerie(std::uint32_t depth = 6) {
    SceneText text("menagerie");
    text.camera({0.25, 1.25, -4}, {0, 0.5, 0}).image(24, 16, 60, true).depth(depth).environment(0.125);
    text.lens(0.05, 4).shutter(0, 1, true);
    text.quad(text.diffuse({0.75, 0.5, 0.25}), {0, 0, 0}, 10, 10);
    text.sphere(text.dielectric(1.5, {0.1, 0.5, 1}, {1, 0.9, 0.8}), {-1, 0.5, 0}, 1);
    text.ellipsoid(text.mirror({0.9, 0.8, 0.7}), {1.25, 0.5, 0.5}, {0.8, 1, 0.5}, {10, 20, 30});
    text.box(text.mix({0.5, 0.6, 0.7}, {0.8, 0.9, 1}, 0.25), {0, 0.25, -0.75}, Vec3d(0.5));
    text.box(text.subsurface({8, 4, 2}, {0.1, 0.2, 0.4}, 0.5, 1.3), {0.25, 0.625, 1}, {0.8, 1, 0.6}, {0, 30, 20});
    text.sphere(text.subsurface({4, 8, 2}, {0.1, 0, 0.3}), {-1.625, 0.375, -1}, 0.6);
    text.sphere(text.diffuse(Vec3d(0.5), {0.5, 0.25, 0.125}), {1, 0.25, -1}, 0.4).velocity({0.5, 0.25, 0});
    text.quad(text.emitter(Vec3d(4.0)), {0, 3, 0}, 1, 1.5, {170, 10, 0});
    text.ellipsoid(text.emitter({2, 4, 8}), {-2, 2, 1}, {0.5, 0.3, 0.4}, {0, 0, 40});
    text.box(text.emitter({8, 4, 2}), {2, 2, 1}, Vec3d(0.3), {10, 20, 30});
    text.box(text.emitter(Vec3d(2.0)), {2, 0.25, -1}, Vec3d(0.2)).velocity({0, 0.5, 0});
    return text.json();
}

// A sphere that touches a plane: the penumbra at the contact ends at the limits of precision.
Json contact() {
    SceneText text("contact");
    text.camera({0, 0.125, -2}, {0, 0, -0.25}).image(24, 16, 10, true).depth(3).environment(1);
    text.quad(text.diffuse(Vec3d(0.5)), {0, 0, 0}, 64, 64);
    text.sphere(text.diffuse(Vec3d(0.75)), {0, 1, 0}, 2);
    return text.json();
}

std::vector<Twins> in_scale(const Values& v) {
    const int k = static_cast<int>(v["k"]);
    const double factor = std::ldexp(1.0, k);
    std::vector<Twins> twins;
    for (const auto& [name, scene] : {std::pair("menagerie", menagerie()), std::pair("contact", contact())}) {
        twins.push_back(
            {.change = fmt::format("{} x 2^{}", name, k), .reference = scene, .changed = scaled(scene, factor)});
    }
    return twins;
}

std::vector<Twins> in_radiance(const Values& v) {
    const int k = static_cast<int>(v["k"]);
    return {{.change = fmt::format("radiance x 2^{}", k),
             .reference = menagerie(),
             .changed = brightened(menagerie(), std::ldexp(1.0, k))}};
}

std::vector<Twins> elsewhere(const Values& v) {
    const double distance = std::round(v["distance"] * 64) / 64;
    const Vec3d offset(distance, -distance, 2 * distance);
    return {{.change = fmt::format("moved by {:g}", distance),
             .reference = menagerie(),
             .changed = moved(menagerie(), offset)}};
}

std::vector<Twins> in_order(const Values&) {
    const Json scene = menagerie();
    Json reversed = scene, rotated = scene;
    std::reverse(reversed["objects"].begin(), reversed["objects"].end());
    std::rotate(rotated["objects"].begin(), rotated["objects"].begin() + 4, rotated["objects"].end());
    return {{.change = "objects in reverse", .reference = scene, .changed = reversed},
            {.change = "objects rotated by four", .reference = scene, .changed = rotated}};
}

// Two coincident quads: which one is hit must not depend on their order in the file.
std::vector<Twins> coincident_in_order(const Values& v) {
    SceneText text("coincident");
    text.image(24, 16, 40, true).depth(3).environment(1);
    for (const double albedo : {0.25, 0.75}) {
        text.quad(text.diffuse(Vec3d(albedo), Vec3d(0.5)), {0, 0, 4}, 8, 8, {90 - v["tilt"], v["tilt"] / 2, 0});
    }
    Json swapped = text.json();
    std::reverse(swapped["objects"].begin(), swapped["objects"].end());
    return {{.change = "coincident quads swapped", .reference = text.json(), .changed = swapped}};
}

// Adds objects that no path hits: a speck of solid angle 1e-18, or objects of all kinds around a closed room.
std::vector<Twins> with_unseen(const Values& v) {
    SceneText room("room");
    room.camera({0, 1, -1.5}, {0, 0.75, 0}).image(24, 16, 80, true).depth(5);
    const std::string wall = room.diffuse({0.75, 0.5, 0.25});
    room.box(wall, {0, 1, 0}, Vec3d(4.0));
    room.sphere(room.dielectric(1.5), {0, 0.5, 0.5}, 1);
    room.quad(room.emitter(Vec3d(4.0)), {0, 2.5, 0}, 1, 1);
    room.box(wall, {1, 0, 0.5}, Vec3d(0.8), {0, 30, 0});
    const double distance = v["distance"];
    SceneText more = room;
    more.sphere(wall, {distance, 0, 0}, 1).ellipsoid(wall, {0, 0, -distance}, {1, 2, 3});
    more.box(wall, {0, distance, 0}, Vec3d(2.0)).box(wall, {0, -distance, 0}, Vec3d(3.0), {10, 20, 30});
    more.quad(wall, {-distance, 0, 0}, 3, 3, {0, 0, 90});
    Json far = menagerie();
    far["objects"].push_back({{"shape", "box"},
                              {"material", far["objects"][0]["material"]},
                              {"translate", list(Vec3d(-1e9, 2e9, 1e9))},
                              {"scale", 1.0}});
    return {{.change = "objects outside of a closed room", .reference = room.json(), .changed = more.json()},
            {.change = "a speck far away", .reference = menagerie(), .changed = far}};
}

// Adds bodies of 1e-18 units, which no path hits.
std::vector<Twins> with_specks(const Values&) {
    Json more = menagerie();
    const auto add = [&](const char* shape, const Vec3d& place, const Vec3d& scale, const Vec3d& turn) {
        more["objects"].push_back({{"shape", shape},
                                   {"material", more["objects"][0]["material"]},
                                   {"translate", list(place)},
                                   {"scale", list(scale)},
                                   {"rotate_degrees", list(turn)}});
    };
    add("sphere", {0.5, 1, -2}, Vec3d(1e-18), Vec3d(0.0));
    add("sphere", {-0.5, 1, -2}, {1e-18, 2e-18, 3e-18}, {10, 20, 30});
    add("box", {0.5, 1.5, -2}, Vec3d(1e-18), Vec3d(0.0));
    add("box", {0.25, 0.75, -2}, {1e-18, 1e-6, 1e-18}, {10, 20, 30});
    add("quad", {-0.25, 0.75, -2}, {1e-18, 1, 1e-6}, {10, 20, 30});
    return {{.change = "bodies of no size", .reference = menagerie(), .changed = more}};
}

std::vector<Twins> in_parts(const Values&) {
    const Json scene = menagerie();
    return {{.change = "two runs of 3 and 5 samples", .reference = scene, .changed = scene, .parts = {3, 5}},
            {.change = "three runs of 1, 2 and 5 samples", .reference = scene, .changed = scene, .parts = {1, 2, 5}},
            {.change = "eight runs", .reference = scene, .changed = scene, .parts = {1, 1, 1, 1, 1, 1, 1, 1}}};
}

// Adds features without effect to a scene: zero velocities, an aperture of 0, and a shutter that opens for no time. The
// scenes with and without them may be rendered by different kernels.
std::vector<Twins> with_idle_features(const Values&) {
    Json still = menagerie();
    for (Json& object : still["objects"]) {
        object.erase("velocity");
    }
    Json stopped = still;
    for (Json& object : stopped["objects"]) {
        object["velocity"] = list(Vec3d(0.0));
    }
    Json pinhole = still, closed = still;
    pinhole["camera"].erase("aperture_radius");
    pinhole["camera"].erase("focus_distance");
    closed["camera"]["aperture_radius"] = 0.0;
    return {{.change = "velocities of 0", .reference = still, .changed = stopped},
            {.change = "an aperture of 0", .reference = pinhole, .changed = closed}};
}

std::vector<Twins> scheduled(const Values&) {
    const Json scene = menagerie();
    std::vector<Twins> twins;
    const auto add = [&](const std::string& tunable, std::uint32_t value) {
        twins.push_back({.change = fmt::format("{} {}", tunable, value),
                         .reference = scene,
                         .changed = scene,
                         .tuning = {{tunable, value}}});
    };
    for (const std::uint32_t threads : {64u, 256u, 512u}) {
        add("block", threads);
    }
    for (const std::uint32_t samples : {2u, 3u, 8u}) {
        add("spp_in_flight", samples);
    }
    add("min_blocks", 2);
    add("read_back", 1);
    add("regenerate_at", 0);
    add("regenerate_at", 31);
    add("piece", 1);
    add("payload", 1);
    return twins;
}

const AxisChoices all_estimators{{axes::direct_light, {"nee", "nee_mis", "final_bounce"}},
                                 {axes::russian_roulette, {"throughput"}}};
constexpr const char* same = "the same film, bit for bit";

const CasesOf<Family::identity> cases({
    {.name = "scene_scale",
     .catalogue = "S11",
     .title = "a scene times a power of two",
     .stiff = "any absolute epsilon becomes the scene's size, or nothing",
     .formula = same,
     .parameters = {{"k", 20, -50, 40, "lengths x 2^k", true}},
     .points = along("k", {-50, -20, -10, -1, 1, 10, 20, 40}),
     .quick_points = along("k", {-50, 40}),
     .sweep = "k",
     .estimators = all_estimators,
     .twins = in_scale},
    {.name = "radiance_scale",
     .catalogue = "S11",
     .title = "all radiances times a power of two",
     .stiff = "thresholds on radiance, clamps and a film in fixed point have a unit of their own",
     .formula = same,
     .parameters = {{"k", 20, -50, 90, "radiance x 2^k", true}},
     .points = along("k", {-50, -20, -1, 1, 20, 40, 90}),
     .quick_points = along("k", {-20, 40}),
     .sweep = "k",
     .estimators = all_estimators,
     .twins = in_radiance},
    {.name = "object_order",
     .catalogue = "S11",
     .title = "the objects of a file in another order",
     .stiff = "object numbers break ties and pick lights",
     .formula = same,
     .estimators = all_estimators,
     .twins = in_order},
    {.name = "unseen_objects",
     .catalogue = "S11",
     .title = "objects that no path meets",
     .stiff = "they widen bounds and shift numbers, and a room that is not closed shows them",
     .formula = same,
     .parameters = {{"distance", 1000, 8, 1e12, "of the objects outside of the room, scene units"}},
     .points = along("distance", {8, 1000, 1e12}),
     .quick_points = {{{"distance", 1000}}},
     .estimators = all_estimators,
     .twins = with_unseen},
    {.name = "sample_parts",
     .catalogue = "S11",
     .title = "the samples of a pixel in several runs",
     .stiff = "random numbers and sums must not know in which run a sample is",
     .formula = same,
     .estimators = all_estimators,
     .twins = in_parts},
    {.name = "scheduling",
     .catalogue = "S11",
     .title = "other block sizes, samples in flight and ways to move paths",
     .stiff = "sums in floating point depend on their order, and numbers keyed by a place in a queue on the queue",
     .formula = same,
     .estimators = all_estimators,
     .twins = scheduled},
    {.name = "idle_features",
     .catalogue = "S11",
     .title = "velocities and an aperture of 0",
     .stiff = "a feature at rest must do no arithmetic: o - v t and F d - o round",
     .formula = same,
     .estimators = all_estimators,
     .twins = with_idle_features},
    {.name = "translation",
     .catalogue = "S12",
     .title = "a scene moved with its camera",
     .stiff = "at 1e7 units single precision has a spacing of 1",
     .formula = same,
     .parameters = {{"distance", 1e6, -1e12, 1e12, "on the axes, in the proportion 1 : -1 : 2, to a 64th"}},
     .points = along("distance", {1e5, 1e6, 1e7, 1e12}),
     .quick_points = {{{"distance", 1e7}}},
     .sweep = "distance",
     .estimators = all_estimators,
     .twins = elsewhere},
    {.name = "coincident_order",
     .catalogue = "S19",
     .title = "two quads in one place, in either order",
     .stiff = "the nearer of two equal distances is decided by order",
     .formula = same,
     .parameters = {{"tilt", 0, 0, 80, "of the quads, degrees"}},
     .points = along("tilt", {0, 20}),
     .estimators = all_estimators,
     .twins = coincident_in_order},
    {.name = "specks",
     .catalogue = "S22",
     .title = "bodies of no size in a scene",
     .stiff = "their inverses are 1e18, and their normals of no length",
     .formula = "the same film as without them, bit for bit",
     .estimators = all_estimators,
     .twins = with_specks},
});

}  // namespace
}  // namespace pt::stability::identity
