// Case S20: closed meshes seen from within, with rays aimed at edges and vertices of triangles. The walls emit nothing
// and a light surrounds the mesh, so the film of a mesh without gaps is exactly 0.
#include <cmath>

#include "harness/stability/case.h"
#include "stability/oracles/stiff_meshes.h"

namespace pt::stability::meshes {
namespace {

constexpr std::uint32_t dark_depth = 9;
constexpr double light_radiance = 16;

// A scene under a bright environment. Half of the light that a wall reflects is mirrored, so that a ray aimed at an
// edge goes on to another edge.
SceneText dark(const std::string& name) {
    SceneText scene(name);
    scene.depth(dark_depth).environment(light_radiance);
    return scene;
}
std::string wall_of(SceneText& scene) { return scene.mix(Vec3d(0.875), Vec3d(0.875), 0.5); }

// The quantities measured in a room without gaps: a black film, and paths of full length.
std::vector<Rendering> stays_dark(const SceneText& scene) {
    const Tolerance none{0, 0, "numerics.md S20: none"};
    return {{.scene = scene.json(),
             .quick_paths = 1u << 12,
             .full_paths = 1u << 14,
             .quantities = {every_pixel_is("radiance of the brightest pixel", 0, none),
                            exactly("segments missing of a path", missing_segments(dark_depth), 0, none)}}};
}

// The field of view in degrees that spans 2 x `half` at distance 1.
double view_of(double half) { return std::atan(half) * 360 / pi<double>; }

// ---- Meshes seen at edges and vertices.

// The 8 x 8 camera rays hit vertices (n = 16) or diagonals (n = 8) of a wall's n x n squares, mirrored ones again.
std::vector<Rendering> triangle_mesh(const Values& v) {
    SceneText scene = dark("triangle_mesh");
    const std::uint32_t n = v.whole("squares");
    scene.image(8, 8, 90, false);
    const std::string wall = wall_of(scene);
    scene.mesh(wall, grid_room(n));
    scene.sphere(scene.emitter(Vec3d(light_radiance)), {0, 0, 3}, 1);
    return stays_dark(scene);
}

// A view of a vertex that many triangles share. Pixels are 2^-24 wide there, less than the spacing of floats at 1.
std::vector<Rendering> shared_vertex(const Values& v) {
    SceneText scene = dark("shared_vertex");
    scene.image(16, 16, view_of(0x1p-20), false);
    scene.mesh(wall_of(scene), spindle(v.whole("triangles")));
    return stays_dark(scene);
}

// A view from between two pages of a `book` (stiff_meshes.h) towards its axis, an edge that many triangles share.
std::vector<Rendering> shared_edge(const Values& v) {
    SceneText scene = dark("shared_edge");
    const double half_angle = pi<double> / v["triangles"];
    const Vec3d eye(0.25 * std::cos(half_angle), 0.25 * std::sin(half_angle), 0.0625);
    scene.camera(eye, {0, 0, -0.03125}, {0, 0, 1}).image(16, 16, view_of(0x1p-20), false);
    scene.mesh(wall_of(scene), book(v.whole("triangles")));
    return stays_dark(scene);
}

// ---- Meshes with needles, and of extreme sizes.

std::vector<Rendering> needles(const Values& v) {
    SceneText scene = dark("needles");
    const int k = static_cast<int>(v["k"]);
    scene.camera({0, 0, -0.25}, {0, 0, 1}).image(16, 16, view_of(std::ldexp(8.0, -k)), false);
    scene.mesh(wall_of(scene), striped_room(v.whole("k")));
    return stays_dark(scene);
}

// A view along a thin tube whose walls consist of needles.
std::vector<Rendering> thin_tube_case(const Values& v) {
    SceneText scene = dark("thin_tube");
    const int k = static_cast<int>(v["k"]);
    scene.camera({0, 0, -0.5}, {0, 0, 1}).image(16, 16, view_of(std::ldexp(1.0, -k)), false);
    scene.mesh(wall_of(scene), thin_tube(16, v.whole("k")));
    return stays_dark(scene);
}

std::vector<Rendering> sizes(const Values& v) {
    SceneText scene = dark("sizes");
    scene.image(16, 16, view_of(std::exp2(v["view"])), false);
    scene.mesh(wall_of(scene), nested_squares(static_cast<int>(v["k"])));
    return stays_dark(scene);
}

// ---- Meshes far away, grazed or sheared.

// A mesh with coordinates far from 0 that its object moves back; all vertices are rounded by moving them.
std::vector<Rendering> far_coordinates(const Values& v) {
    SceneText scene = dark("far_coordinates");
    const double distance = 2 * std::exp2(v["k"]) - 1;  // odd: corners of the moved room are exact floats up to k = 23
    const Mesh mesh = moved_by(grid_room(4), distance, -distance, distance);
    scene.camera({0, 0, 0}, {0.25, 0.125, 1}).image(16, 16, 90, true);
    const std::string wall = wall_of(scene);
    const Vec3d back(-distance, distance, -distance);
    scene.mesh(wall, mesh, back);
    if (v.is_set("instances")) {  // a second object keeps the loader from moving the mesh to scene space
        scene.mesh(wall, mesh, back + Vec3d(4, 0, 0));
    }
    return stays_dark(scene);
}

// An eye so close to a wall that rays run along it across all its edges.
std::vector<Rendering> grazing(const Values& v) {
    SceneText scene = dark("grazing_mesh");
    const double height = std::exp2(-v["k"]);
    scene.camera({0.0625, 0, -0.96875}, {0.0625, 0, 1}).image(32, 33, view_of(4 * height), false);
    const Mesh room = grid_room(v.whole("squares"));
    scene.mesh(wall_of(scene), room, {0, 1 - height, 0});
    return stays_dark(scene);
}

// A rotated room stretched along an axis (a shear), shared by two objects: rays are moved into the mesh's space.
std::vector<Rendering> shear(const Values& v) {
    SceneText scene = dark("shear");
    const double s = std::exp2(v["k"]), c = std::sqrt(0.5);
    Mesh mesh = grid_room(4);
    for (auto& p : mesh.vertices) {
        const double x = p[0], y = p[1];
        p[0] = static_cast<float>(c * (x - y));
        p[1] = static_cast<float>(c * (x + y));
    }
    scene.camera({0, 0, 0}, {0.25, 0.5, 1}).image(16, 16, 90, true);
    const std::string wall = wall_of(scene);
    scene.mesh(wall, mesh, {0, 0, 0}, {s, 1, 1}, {10, 20, 30});
    scene.mesh(wall, mesh, {8 * s, 8 * s, 8 * s}, {s, 1, 1}, {30, 20, 10});
    return stays_dark(scene);
}

// ---- Meshes at the limits of single precision.

// The known limit of a thin tube: a path starts in front of the plane that it has hit, by a bound on the rounding of
// the hit point: 8 roundings of its coordinates.
std::string too_thin(const Values& v, const VariantTraits& variant) {
    if (!variant.precision.is_single()) {
        return "in double the test of a triangle has nothing wider to ask: a needle's weights and its distance are "
               "differences of rounded products; cure: these products in two parts, as they are exact in single";
    }
    return v["k"] > 16 ? "the tube is as thin as the rounding of points at its ends: what starts before one wall "
                         "starts behind the next; cure: precision=double"
                       : "";
}
std::string too_far(const Values& v, const VariantTraits& variant) {
    return variant.precision.is_single() && v.is_set("instances") && v["k"] > 14
               ? "an instance's rays are taken into the mesh's own space, where the spacing of numbers is a part of "
                 "the "
                 "room: what starts before a wall is rounded behind another; cure: a mesh about its own origin, or "
                 "precision=double"
               : "";
}
std::string too_flat(const Values& v, const VariantTraits& variant) {
    return variant.precision.is_single() && v["k"] < -15
               ? "a room flatter than the rounding of its points: what starts before one wall starts behind the "
                 "other; cure: precision=double"
               : "";
}

const AxisChoices connected{{axes::direct_light, {"nee"}}};
constexpr const char* nothing = "no ray leaves: 0 of the light outside, and every path as long as it may be";

const CasesOf<Family::meshes> cases({
    {.name = "triangle_mesh",
     .catalogue = "S20",
     .title = "a closed room of triangles, looked at along its vertices and edges",
     .stiff = "a ray through a vertex may slip between all triangles that meet there, and their boxes touch there too",
     .formula = nothing,
     .parameters = {{"squares", 8, 1, 64, "a side of a wall", true}},
     .points = along("squares", {2, 8, 16}),
     .quick_points = {{{"squares", 16}}},
     .estimators = connected,
     .over_accelerators = true,
     .renderings = triangle_mesh},
    {.name = "shared_vertex",
     .catalogue = "S20",
     .title = "rays within a few roundings of a vertex",
     .stiff = "up to a thousand triangles end there, and the ray passes each by less than a rounding",
     .formula = nothing,
     .parameters = {{"triangles", 100, 3, 4096, "that share the vertex", true}},
     .points = along("triangles", {3, 4, 100, 1000}),
     .quick_points = {{{"triangles", 1000}}},
     .sweep = "triangles",
     .over_accelerators = true,
     .renderings = shared_vertex},
    {.name = "shared_edge",
     .catalogue = "S20",
     .title = "rays within a few roundings of an edge of many triangles",
     .stiff = "up to a thousand triangles are met at one distance, and boxes of all of them touch there",
     .formula = nothing,
     .parameters = {{"triangles", 100, 3, 4096, "that share the edge", true}},
     .points = along("triangles", {3, 100, 1000}),
     .quick_points = {{{"triangles", 1000}}},
     .sweep = "triangles",
     .over_accelerators = true,
     .renderings = shared_edge},
    {.name = "needles",
     .catalogue = "S20",
     .title = "walls with strips two million times longer than wide",
     .stiff = "the weights of a needle are differences of almost equal products, and its box is an edge",
     .formula = nothing,
     .parameters = {{"k", 20, 1, 22, "strips 2^-k wide and 2 long", true}},
     .points = along("k", {4, 10, 20}),
     .quick_points = {{{"k", 20}}},
     .sweep = "k",
     .over_accelerators = true,
     .renderings = needles},
    {.name = "thin_tube",
     .catalogue = "S20",
     .title = "a tube of needles from within",
     .stiff = "next to every point of a wall there is another wall, as far as a rounding of its length",
     .formula = nothing,
     .parameters = {{"k", 10, 1, 22, "radius 2^-k of a tube of length 2", true}},
     .points = along("k", {4, 10, 20}),
     .quick_points = along("k", {10, 20}),
     .sweep = "k",
     .over_accelerators = true,
     .renderings = thin_tube_case,
     .known_limit = too_thin},
    {.name = "sizes",
     .catalogue = "S20",
     .title = "triangles of a millionth beside triangles of a million",
     .stiff = "one tree holds boxes that differ by a factor of 2^40, in one plane",
     .formula = nothing,
     .parameters = {{"k", 20, 1, 30, "half sides from 2^-k to 2^k", true},
                    {"view", 0, -22, 6, "half the image's width at the plane, 2^n"}},
     .points = {{{"k", 4}, {"view", 0}}, {{"view", 0}}, {{"view", -10}}, {{"view", -20}}},
     .quick_points = along("view", {0, -20}),
     .over_accelerators = true,
     .renderings = sizes},
    {.name = "far_coordinates",
     .catalogue = "S20",
     .title = "a mesh whose own coordinates are far from 0",
     .stiff = "at 2^23 diameters single precision has a spacing of half a wall, and vertices fall together",
     .formula = nothing,
     .parameters = {{"k", 13, 0, 24, "2^k diameters from 0", true},
                    {"instances", 0, 0, 1, "0: one object, 1: two that share it", true}},
     .points = joined({along("k", {13, 17, 20, 23}), table({"k", "instances"}, {{13, 1}, {20, 1}})}),
     .quick_points = {{{"k", 23}}, {{"k", 13}, {"instances", 1}}},
     .sweep = "k",
     .over_accelerators = true,
     .renderings = far_coordinates,
     .known_limit = too_far},
    {.name = "grazing_mesh",
     .catalogue = "S20",
     .title = "rays that run along a wall of triangles",
     .stiff = "at a grazing angle every edge of a row is within a rounding of the ray",
     .formula = nothing,
     .parameters = {{"k", 20, 1, 60, "the eye 2^-k above the wall", true},
                    {"squares", 16, 1, 64, "a side of a wall", true}},
     .points = {{{"k", 10}, {"squares", 2}}, {{"k", 10}}, {{"k", 20}}, {{"k", 23}}},
     .quick_points = {{{"k", 20}}},
     .sweep = "k",
     .over_accelerators = true,
     .renderings = grazing},
    {.name = "sheared_instances",
     .catalogue = "S20",
     .title = "a room under a strong shear, as an instance",
     .stiff =
         "rays are taken into the mesh's space by a matrix whose rows differ by a factor of 2^k, and rounded there",
     .formula = nothing,
     .parameters = {{"k", 10, -20, 20, "stretched by 2^k along one axis", true}},
     .points = along("k", {0, 4, 10, -10, 20, -20}),
     .quick_points = {{{"k", 10}}},
     .sweep = "k",
     .over_accelerators = true,
     .renderings = shear,
     .known_limit = too_flat},
});

}  // namespace
}  // namespace pt::stability::meshes
