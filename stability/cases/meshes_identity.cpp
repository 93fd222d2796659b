// Changes of meshes that must not change a film, bit for bit: order of triangles, scaling by powers of two,
// translation, degenerate triangles; and the order of coplanar triangles.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "harness/mesh/check_mesh.h"
#include "harness/stability/case.h"
#include "stability/oracles/stiff_meshes.h"

namespace pt::stability::meshes_identity {
namespace {

// A lit room made of a mesh, with other meshes as a light, as glass, and as two instances of one. Positions are
// multiples of 2^-6. `as_given` is applied to each mesh.
template <class Change>
SceneText mesh_room(const Change& as_given) {
    SceneText text("mesh_room");
    text.camera({0.25, 0.25, -0.75}, {0, 0, 0.5}).image(16, 12, 70, true).depth(6).environment(0.5);
    text.mesh(text.diffuse({0.75, 0.5, 0.25}), as_given(grid_room(3)));
    text.mesh(text.emitter({8, 6, 4}), as_given(spindle(5)), {-0.5, 0.5, 0.25}, Vec3d(0.125), {10, 20, 30});
    text.mesh(text.dielectric(1.5), as_given(grid_room(2)), {0.5, -0.25, 0.25}, Vec3d(0.25), {30, 20, 10});
    const std::string mirror = text.mirror({0.9, 0.8, 0.7});
    text.mesh(mirror, as_given(spindle(7)), {0.25, 0.5, 0.5}, {0.25, 0.5, 0.125}, {40, 0, 20});
    text.mesh(mirror, as_given(spindle(7)), {-0.375, -0.5, 0.5}, {0.125, 0.25, 0.25}, {0, 40, 0});
    return text;
}
SceneText mesh_room() {
    return mesh_room([](const Mesh& mesh) { return mesh; });
}

std::vector<Twins> in_order(const Values& v) {
    const std::uint64_t seed = v.whole("seed");
    return {{.change = "triangles and vertices shuffled",
             .reference = mesh_room().json(),
             .changed = mesh_room([seed](const Mesh& mesh) { return shuffled(mesh, seed); }).json()}};
}

std::vector<Twins> in_scale(const Values& v) {
    const int k = static_cast<int>(v["k"]);
    const Json scene = mesh_room().json();
    return {
        {.change = fmt::format("meshes x 2^{}", k), .reference = scene, .changed = scaled(scene, std::ldexp(1.0, k))}};
}

std::vector<Twins> elsewhere(const Values& v) {
    const double distance = 2 * std::exp2(v["k"]);
    const Json scene = mesh_room().json();
    return {{.change = fmt::format("moved by 2^{:g} diameters", v["k"]),
             .reference = scene,
             .changed = moved(scene, {distance, -distance, 2 * distance})}};
}

std::vector<Twins> without_flat_ones(const Values&) {
    return {{.change = "triangles without area among the others",
             .reference = mesh_room().json(),
             .changed = mesh_room(with_flat_ones).json()}};
}

// Degenerate triangles, three in four of this mesh, must be left out and counted.
std::vector<Measurement> counted_flat_ones(const Values&, const DirectSetting&) {
    Mesh mesh = with_flat_ones(spindle(64));
    const auto before = static_cast<double>(mesh.triangles.size());
    check_mesh(mesh, "a case");
    const Tolerance none{0, 0, "a count"};
    return {{.quantity = "triangles without area that are counted",
             .measured = static_cast<double>(mesh.degenerate_left_out),
             .exact = before * 3 / 4,
             .tolerance = none},
            {.quantity = "triangles that are left",
             .measured = static_cast<double>(mesh.triangles.size()),
             .exact = before / 4,
             .tolerance = none}};
}

// Two coincident meshes with different materials.
std::vector<Twins> coplanar_in_order(const Values&) {
    SceneText text("coplanar_meshes");
    text.camera({0.25, 0.25, -0.75}, {0, 0, 0.5}).image(16, 12, 70, true).depth(5).environment(1);
    for (const double albedo : {0.25, 0.75}) {
        text.mesh(text.diffuse(Vec3d(albedo), Vec3d(0.5)), spindle(7), {0, 0, 0.5}, Vec3d(0.5), {10, 20, 30});
    }
    Json swapped = text.json();
    std::reverse(swapped["objects"].begin(), swapped["objects"].end());
    return {{.change = "meshes in one place swapped", .reference = text.json(), .changed = swapped}};
}

std::vector<Twins> coplanar_twins(const Values&) {
    const auto scene = [](const Mesh& mesh) {
        SceneText text("coplanar_twins");
        text.camera({0.25, 0.25, -0.75}, {0, 0, 0.5}).image(16, 12, 70, true).depth(2).environment(1);
        text.mesh(text.emitter({4, 2, 1}), mesh, {0, 0, 0.5}, Vec3d(0.5), {10, 20, 30});
        return text.json();
    };
    return {{.change = "every triangle twice", .reference = scene(spindle(7)), .changed = scene(doubled(spindle(7)))}};
}

const AxisChoices connected{{axes::direct_light, {"nee", "nee_mis"}}};
constexpr const char* same = "the same film, bit for bit";

const CasesOf<Family::meshes> cases({
    {.name = "mesh_order",
     .catalogue = "S11",
     .title = "the triangles of a mesh in another order",
     .stiff = "primitive numbers break ties and pick points of lights",
     .formula = same,
     .parameters = {{"seed", 1, 0, 4294967295.0, "of the order", true}},
     .points = along("seed", {1, 2}),
     .estimators = connected,
     .over_accelerators = true,
     .twins = in_order},
    {.name = "mesh_scale",
     .catalogue = "S11",
     .title = "meshes times a power of two",
     .stiff = "boxes are padded and quantised, and a triangle's area is a product of two small numbers",
     .formula = same,
     .parameters = {{"k", 20, -50, 40, "lengths x 2^k", true}},
     .points = along("k", {-50, -20, -1, 1, 20, 40}),
     .quick_points = along("k", {-50, 40}),
     .sweep = "k",
     .estimators = connected,
     .over_accelerators = true,
     .twins = in_scale},
    {.name = "mesh_translation",
     .catalogue = "S12",
     .title = "meshes moved with their camera, up to ten million diameters",
     .stiff = "at 2^24 units single precision has a spacing of 2",
     .formula = same,
     .parameters = {{"k", 13, 0, 30, "by 2^k diameters", true}},
     .points = along("k", {13, 20, 23}),
     .quick_points = {{{"k", 23}}},
     .sweep = "k",
     .over_accelerators = true,
     .twins = elsewhere},
    {.name = "coplanar_meshes",
     .catalogue = "S19",
     .title = "two meshes in one place, in either order",
     .stiff = "all of their triangles are met at one distance, and a tree may reach either first",
     .formula = same,
     .estimators = connected,
     .over_accelerators = true,
     .twins = coplanar_in_order},
    {.name = "coplanar_twins",
     .catalogue = "S19",
     .title = "a mesh that has every triangle twice",
     .stiff = "a builder finds no plane between twins, and a light has its area twice",
     .formula = same,
     .over_accelerators = true,
     .twins = coplanar_twins},
    {.name = "flat_triangles",
     .catalogue = "S22",
     .title = "triangles without area in a mesh",
     .stiff = "their normals have no length, and their weights are 0 / 0",
     .formula = "the same film as without them, bit for bit",
     .estimators = connected,
     .over_accelerators = true,
     .twins = without_flat_ones},
    {.name = "flat_triangles_counted",
     .catalogue = "S22",
     .title = "triangles without area are left out aloud",
     .stiff = "what is silently left out is missed by nobody",
     .formula = "three of four are left out, and counted",
     .direct = counted_flat_ones},
});

}  // namespace
}  // namespace pt::stability::meshes_identity
