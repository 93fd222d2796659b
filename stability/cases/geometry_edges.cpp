// Cases S20 and S21: rays at edges and vertices of boxes and tiled walls.
#include <algorithm>
#include <cmath>
#include <type_traits>

#include "stability/oracles/direct_rays.h"

namespace pt::stability::geometry_edges {
namespace {

// ---- Case S21: boxes hit at their edges.

// A ray that passes exactly through a point on an edge: all coordinates are multiples of 2^-11 below 16.
template <class Real>
struct EdgeRay {
    Vec3<Real> origin, direction;
};

template <class Real>
Vec3<Real> grid_point(RayRandom& random, double half, double step) {
    const auto on_grid = [&] { return static_cast<Real>(std::round(random.uniform(-half, half) / step) * step); };
    return {on_grid(), on_grid(), on_grid()};
}

// A ray from outside to a point on an edge of the box around 0. `in_plane`: the ray runs along a face at that edge.
template <class Real>
EdgeRay<Real> ray_through_edge(RayRandom& random, const Vec3d& half, bool in_plane) {
    const int axis = static_cast<int>(random.below(3));
    Vec3<Real> target = grid_point<Real>(random, 8, 1.0 / 64);
    for (int k = 0; k < 3; ++k) {
        const auto extent = static_cast<Real>(half[k]);
        target[k] = k != axis ? (random.below(2) == 0 ? extent : -extent)
                              : std::round(static_cast<Real>(random.uniform(-1, 1)) * extent * 64) / 64;
    }
    Vec3<Real> origin = grid_point<Real>(random, 8, 1.0 / 8);
    const int outside = (axis + 1 + static_cast<int>(random.below(2))) % 3;
    origin[outside] = (random.below(2) == 0 ? Real(1) : Real(-1)) * (Real(9) + origin[outside] / 16);
    if (in_plane) {
        const int plane = 3 - axis - outside;
        origin[plane] = target[plane];
    }
    return {origin, (target - origin) * Real(1.0 / 32)};
}

template <class Real, FeatureSet formula>
std::vector<Measurement> box_edges_in(const Values& v, const DirectSetting& setting) {
    constexpr bool is_mixed = (formula & static_cast<FeatureSet>(Feature::double_intersection)) != 0;
    using Wide = std::conditional_t<is_mixed, double, Real>;
    const double height = v["half_height"];
    const Vec3d half(0.5, 1, height < 1e-7 ? height : std::max(1.0, std::round(64 * height)) / 64);
    SceneText text("box_edges");
    text.box(text.diffuse(Vec3d(0.5)), {0, 0, 0}, half * 2.0);
    const RayScene<Real, formula> scene(text);
    const OrientedBox<Wide> oriented{Vec3<Wide>(Wide(0)),
                                     {Vec3<Wide>(1, 0, 0), Vec3<Wide>(0, 1, 0), Vec3<Wide>(0, 0, 1)},
                                     Vec3<Wide>(rounded<Real>(half))};
    RayRandom random(21);
    double missed = 0, missed_oriented = 0, missed_in_plane = 0;
    const int count = setting.is_quick ? 50000 : 2000000;
    for (int i = 0; i < count; ++i) {
        const bool in_plane = i % 4 == 0;
        const EdgeRay<Real> ray = ray_through_edge<Real>(random, half, in_plane);
        const bool hits = scene.closest(scene.ray(ray.origin, ray.direction)).side.exists();
        (in_plane ? missed_in_plane : missed) += hits ? 0 : 1;
        const Vec3<Wide> origin(ray.origin), direction(ray.direction);
        if constexpr ((formula & static_cast<FeatureSet>(Feature::naive)) != 0) {
            missed_oriented += naive::interval(oriented, origin, direction).hits ? 0 : 1;
        } else {
            missed_oriented += interval(oriented, origin, direction).hits ? 0 : 1;
        }
    }
    const Tolerance none{0, 0, "numerics.md S21: none with Ize's factor 1 + 2 gamma(3)"};
    return {
        {.quantity = "rays through an edge that miss the axis box", .measured = missed, .tolerance = none},
        {.quantity = "rays along a face that miss the axis box", .measured = missed_in_plane, .tolerance = none},
        {.quantity = "rays of both kinds that miss the oriented box", .measured = missed_oriented, .tolerance = none}};
}

std::vector<Measurement> box_edges(const Values& v, const DirectSetting& setting) {
    return in_setting(setting,
                      [&]<class Real, FeatureSet formula>() { return box_edges_in<Real, formula>(v, setting); });
}

// ---- Case S21 as a scene: an eye in the plane of a box's face.

// An eye in the plane of a box's face, or of a flat box, such that one row of pixels looks along the plane.
std::vector<Rendering> face_row(const Values& v) {
    constexpr std::uint32_t width = 32, height = 33;
    std::vector<Rendering> renderings;
    const auto add = [&](const std::string& name, double centre, double thickness, double rows) {
        SceneText text("face_row");
        text.image(width, height, 60, false);
        text.box(text.emitter(Vec3d(1.0)), {0, centre, 4}, {64, thickness, 2});
        const double exact = rows / height;
        renderings.push_back({.scene = text.json(),
                              .quick_paths = width * height,
                              .full_paths = 16 * width * height,
                              .quantities = {exactly(name, mean_radiance, exact, {1e-7, 1e-12, "one row is 0.03"})}});
    };
    // The eye is level with the box's top: the box covers the lower half of the image and the row along its top face.
    add("part of the image that a box seen along its top face covers", -64, 128, 17);
    add("part of the image that a box without thickness covers", 0, v["thickness"], 1);
    return renderings;
}

// ---- Case S20: a closed room of tiles.

enum class Tile { quad, box };

// A scene with six walls of tiles around `centre` + [-1, 1]^3.
SceneText tiled_room(Tile tile, int tiles, const Vec3d& centre) {
    SceneText text("tiled_room");
    const std::string material = text.diffuse(Vec3d(0.5));
    const double size = 2.0 / tiles;
    const double thickness = 0.25;
    for (int axis = 0; axis < 3; ++axis) {
        for (const double side : {-1.0, 1.0}) {
            for (int i = 0; i < tiles * tiles; ++i) {
                Vec3d place(0.0);
                place[axis] = side * (tile == Tile::quad ? 1 : 1 + thickness / 2);
                place[(axis + 1) % 3] = (i % tiles + 0.5) * size - 1;
                place[(axis + 2) % 3] = (i / tiles + 0.5) * size - 1;
                if (tile == Tile::quad) {
                    // Tiles are squares, so any quarter turn that puts the normal on the axis will do.
                    text.quad(material, centre + place, size, size,
                              axis == 0   ? Vec3d(0, 0, 90)
                              : axis == 1 ? Vec3d(0.0)
                                          : Vec3d(90, 0, 0));
                } else {
                    Vec3d scale(size);
                    scale[axis] = thickness;
                    text.box(material, centre + place, scale);
                }
            }
        }
    }
    return text;
}

template <class Real, FeatureSet formula>
double leaks(const SceneText& text, const Vec3d& centre, int tiles, int count) {
    const RayScene<Real, formula> scene(text);
    RayRandom random(20);
    double missed = 0;
    for (int i = 0; i < count; ++i) {
        const Vec3<Real> origin = rounded<Real>(centre + random.in_cube(0.9));
        // Rays are aimed at vertices of a wall's grid of tiles, or at points on grid lines.
        const int axis = static_cast<int>(random.below(3));
        const auto line = [&] { return -1 + 2.0 * random.below(static_cast<std::uint32_t>(tiles) + 1) / tiles; };
        Vec3d target(0.0);
        target[axis] = random.below(2) == 0 ? -1 : 1;
        target[(axis + 1) % 3] = line();
        target[(axis + 2) % 3] = i % 2 == 0 ? line() : random.uniform(-1, 1);
        const Ray<Real> ray = scene.ray(origin, direction_to(origin, centre + target));
        missed += scene.closest(ray).side.exists() ? 0 : 1;
    }
    return missed;
}

template <class Real, FeatureSet formula>
std::vector<Measurement> tiles_in(const Values& v, const DirectSetting& setting) {
    const int tiles = static_cast<int>(v["tiles"]);
    const Vec3d centre(v["offset"]);
    const int count = (setting.is_quick ? 2000000 : 100000000) / (6 * tiles * tiles);
    const Tolerance none{0, 0, "numerics.md S20: none"};
    return {{.quantity = "rays that leave a room of quads",
             .measured = leaks<Real, formula>(tiled_room(Tile::quad, tiles, centre), centre, tiles, count),
             .tolerance = none},
            {.quantity = "rays that leave a room of boxes",
             .measured = leaks<Real, formula>(tiled_room(Tile::box, tiles, centre), centre, tiles, count),
             .tolerance = none}};
}

std::vector<Measurement> tiles(const Values& v, const DirectSetting& setting) {
    return in_setting(setting, [&]<class Real, FeatureSet formula>() { return tiles_in<Real, formula>(v, setting); });
}

// The known limit of a room of tiles: the place of each tile is rounded separately, so that edges of neighbours differ
// where the precision cannot represent them.
std::string tiles_part(const Values& v, const VariantTraits& variant) {
    const double edge = v["offset"] + 1 / v["tiles"];
    const bool held_in_float = static_cast<double>(static_cast<float>(edge)) == edge;
    const bool held =
        edge - v["offset"] == 1 / v["tiles"] && std::exp2(std::round(std::log2(v["tiles"]))) == v["tiles"];
    if (variant.precision.is_double()) {
        return held ? ""
                    : "tiles share no vertices: a centre and half a side that are no sums of powers of two are rounded "
                      "by "
                      "themselves, so that neighbours' edges differ by a rounding, and of 1e8 rays along edges one or "
                      "two slip through; cure: vertices that tiles share";
    }
    // Near the eye, the rounding of the ray interval covers the gap between tiles in single precision, not in double.
    if (held_in_float || (variant.precision.is_single() && v["offset"] < 4)) {
        return "";
    }
    return "tiles share no vertices: each centre is rounded to single precision by itself, and gaps as wide as the "
           "spacing of numbers at that distance from the eye open between them; cure: precision=double";
}

const CasesOf<Family::geometry> cases({
    {.name = "tiled_room",
     .catalogue = "S20",
     .title = "a closed room of tiles, aimed at from within along their edges and vertices",
     .stiff = "every ray meets the wall where four tiles touch, and each tile's test is rounded by itself",
     .formula = "no ray leaves",
     .parameters = {{"tiles", 8, 1, 64, "a side of a wall", true},
                    {"offset", 0, 0, 1e6, "of the room's centre from the eye, on each axis, scene units"}},
     .points = joined({along("tiles", {1, 8, 48}), along("offset", {1e2, 1e4, 148376}),
                       table({"tiles", "offset"}, {{48, 1e2}})}),
     .quick_points = {{{"tiles", 1}}, {{"tiles", 8}}, {{"offset", 148376}}},
     .direct = tiles,
     .direct_has_naive = true,
     .direct_has_mixed = true,
     .known_limit = tiles_part},
    {.name = "box_edges",
     .catalogue = "S21",
     .title = "rays through the edges of a box, and along its faces",
     .stiff = "entry and exit are one point, and times by reciprocals put the exit before the entry in 4 % of the rays",
     .formula = "every ray passes through a point of the closed box exactly: all must hit",
     .parameters = {{"half_height", 2, 1e-18, 8, "of the box, scene units, to a 64th; below 1e-7 as it is"}},
     .points = along("half_height", {2, 0.25, 1e-18}),
     .quick_points = along("half_height", {2, 1e-18}),
     .direct = box_edges,
     .direct_has_naive = true,
     .direct_has_mixed = true},
    {.name = "face_row",
     .catalogue = "S21",
     .title = "an eye in the plane of a box's face",
     .stiff = "0 * infinity: in which order a minimum takes its operands decides whether rays along a face hit it",
     .formula = "17 of 33 rows for a face on the horizon, one for a box without thickness: a box is closed",
     .parameters = {{"thickness", 1e-18, 1e-18, 0.01, "of the flat box, scene units"}},
     .points = along("thickness", {1e-18, 1e-6}),
     .renderings = face_row},
});

}  // namespace
}  // namespace pt::stability::geometry_edges
