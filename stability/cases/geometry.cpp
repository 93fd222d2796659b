// Cases S13 to S15: spheres that are huge or far away, and rays that start on a body.
#include <algorithm>
#include <cmath>
#include <type_traits>

#include "stability/oracles/direct_rays.h"

namespace pt::stability::geometry {
namespace {

constexpr double round_off(bool is_double) { return is_double ? 0x1p-53 : 0x1p-24; }

// ---- Case S13: a sphere of radius R below an eye at height h.

SceneText ground_text(const Values& v) {
    SceneText text("huge_sphere");
    text.camera({0, v["height"], 0}, {0, v["height"], 1});
    text.sphere(text.emitter(Vec3d(1.0)), {0, -v["radius"], 0}, 2 * v["radius"]);
    return text;
}

// Where a ray from the origin hits the ground sphere below: distance t, and cosine to the normal. With the centre on
// the y axis, t is a difference of two numbers.
struct GroundHit {
    long double t, cosine;
};
GroundHit exact_ground_hit(const Values& v, const Vec3l& direction) {
    const long double height = v["height"], radius = v["radius"];
    const long double a = dot(direction, direction);
    const long double b = -(radius + height) * direction.y;
    const long double c = height * (2 * radius + height);
    const long double root = sqrtl(b * b - a * c);
    return {c / (b + root), root / radius};
}

template <class Real, FeatureSet formula>
std::vector<Measurement> huge_sphere_in(const Values& v, const DirectSetting& setting) {
    const RayScene<Real, formula> scene(ground_text(v));
    const long double dip = sqrtl(v["height"] * (2 * v["radius"] + v["height"])) / v["radius"];  // tan(dip of horizon)
    RayRandom random(13);
    double off_tangent = 0, near_tangent = 0;
    for (int i = 0; i < (setting.is_quick ? 20000 : 1000000); ++i) {
        const bool is_near = i % 2 != 0;
        // Rays off the tangent meet the ground at cosines above 0.1; rays near it are aimed just below the horizon.
        const double lowest = is_near ? 1.001 * std::atan(static_cast<double>(dip)) : std::asin(0.1);
        const double highest = is_near ? std::max(0.1, 1.1 * lowest) : 0.5 * pi<double>;
        const double angle = lowest * std::pow(highest / lowest, random.uniform(0, 1));
        const double azimuth = random.uniform(0, 2 * pi<double>);
        const auto ray =
            scene.ray(Vec3<Real>(Real(0)), rounded<Real>({std::cos(azimuth) * std::cos(angle), -std::sin(angle),
                                                          std::sin(azimuth) * std::cos(angle)}));
        const GroundHit exact = exact_ground_hit(v, Vec3l(ray.direction));
        if (!(exact.cosine > (is_near ? 0.0L : 0.1L))) {
            continue;
        }
        const auto hit = scene.closest(ray);
        const auto error =
            hit.side.exists() ? static_cast<double>(std::abs(static_cast<long double>(hit.t) / exact.t - 1)) : 1.0;
        if (is_near) {
            near_tangent = std::max(near_tangent, error * static_cast<double>(exact.cosine));
        } else {
            off_tangent = std::max(off_tangent, error);
        }
    }
    const Tolerance tolerance{1e-6, 1e-14, "numerics.md S13: compensated forms reach 3e-7 in single precision"};
    return {
        {.quantity = "relative error of the distance, off the tangent",
         .measured = off_tangent,
         .tolerance = tolerance},
        {.quantity = "the same near the tangent, times the cosine", .measured = near_tangent, .tolerance = tolerance}};
}

std::vector<Measurement> huge_sphere(const Values& v, const DirectSetting& setting) {
    return in_setting(setting,
                      [&]<class Real, FeatureSet formula>() { return huge_sphere_in<Real, formula>(v, setting); });
}

// ---- Case S13 as a scene: the ground's distance, seen through an absorbing medium of index 1, and the horizon.

std::vector<Rendering> ground_view(const Values& v) {
    const double h = v["height"], radius = v["radius"];
    constexpr double sigma = 0.25;
    SceneText text = ground_text(v);
    text.camera({0, h, 0}, {0, h - 1, 2});
    text.box(text.dielectric(1, Vec3d(sigma / h)), {0, h, 0}, Vec3d(64 * h));
    const long double b = (radius + static_cast<long double>(h)) / sqrtl(5);
    const long double c = static_cast<long double>(h) * (2 * static_cast<long double>(radius) + h);
    const auto distance = static_cast<double>(c / (b + sqrtl(b * b - c)));
    const double exact = std::exp(-sigma * distance / h);

    // The horizon is a hyperbola in the image plane.
    const double dip = std::sqrt(h * (2 * radius + h)) / radius;
    const double half = 3.5 * dip;  // half the image's height; the horizon lies between two rows of pixels
    SceneText horizon = ground_text(v);
    horizon.image(16, 16, 2 * std::atan(half) * 180 / pi<double>, true);
    const double covered = 0.5 - dip * (std::sqrt(1 + half * half) + std::asinh(half) / half) / (4 * half);
    const auto horizon_error = [&](bool is_double) { return 4 * round_off(is_double) / (2 * half); };
    return {
        {.scene = text.json(),
         .quick_paths = 16,
         .full_paths = 1024,
         .quantities = {every_pixel_is("transmittance of the way to the ground", exact,
                                       {1e-6, 1e-12, "numerics.md S13: the distance to 1e-6; the film's quantum"})}},
        {.scene = horizon.json(),
         .quick_paths = 1u << 17,
         .quantities = {mean_is("part of the image below the horizon", covered,
                                {horizon_error(false), horizon_error(true),
                                 "4 roundings of where the sphere and a ray point to, over the image's height"})}}};
}

// ---- Case S14: a sphere far away.

std::vector<Rendering> far_sphere(const Values& v) {
    const double distance = v["distance"];
    const Vec3d view = Vec3d(2, 3, 6) * (1 / 7.0);
    const double radius = 1 / std::sqrt((distance - 1) * (distance + 1));  // radius of the sphere's disc at distance 1
    const double half = 1.25 * radius;
    SceneText text("far_sphere");
    text.camera({0, 0, 0}, view).image(16, 16, 2 * std::atan(half) * 180 / pi<double>, true);
    text.sphere(text.emitter(Vec3d(1.0)), view * distance, 2);
    const double covered = pi<double> * radius * radius / (4 * half * half);
    const auto blur = [&](bool is_double) {
        // If rounding blurs the rim of the sphere's disc evenly by e radii, the disc's area grows by the share e^2.
        const double rim = 8 * round_off(is_double) * distance;
        return covered * (rim * rim + 4 * round_off(is_double)) + 0x1p-40;
    };
    return {{.scene = text.json(),
             .quick_paths = 1u << 17,
             .quantities = {
                 mean_is("part of the image that the disc covers", covered,
                         {blur(false), blur(true), "the square of the rim's blur by 8 roundings of a direction"})}}};
}

// ---- Case S15: rays that start on a body.

struct StartedRays {
    std::uint64_t self_hits = 0, inward = 0;
    double worst_chord = 0;  // largest error of a chord's length, in radii of the body
};

// Traces rays in random directions from points on the scene's only object; `body`: its form for exact chords.
template <class Rays, class Body>
StartedRays start_rays(const Rays& scene, const Body& body, const Vec3d& centre, double radius, int count) {
    using Real = typename Rays::Real;
    constexpr bool has_inside = !std::is_same_v<Body, Quad<float>> && !std::is_same_v<Body, Quad<double>>;
    RayRandom random(15);
    StartedRays result;
    for (int i = 0; i < count; ++i) {
        const Vec3<Real> eye = rounded<Real>(centre + random.on_sphere() * (4 * radius));
        const auto incoming = scene.ray(eye, direction_to(eye, centre + random.in_cube(0.3 * radius)));
        const auto hit = scene.robust_closest(incoming);
        if (!hit.side.exists()) {
            continue;
        }
        const auto point = scene.surface(incoming, hit);
        const Vec3<Real> direction = rounded<Real>(random.on_sphere());
        const bool inward = dot(Vec3l(point.normal), Vec3l(direction)) < 0;
        const auto next = scene.closest(scene.ray(point.position, direction, SurfaceId::of(0, inward)));
        if (!inward || !has_inside) {
            result.self_hits += next.side.exists() ? 1 : 0;
            continue;
        }
        const Chord exact = exact_chord(body, Vec3l(point.position), Vec3l(direction));
        const long double met = next.side.exists() ? static_cast<long double>(next.t) : 0.0L;
        const auto error = static_cast<double>(std::abs(met - exact.t) * exact.slant) / radius;
        result.inward += 1;
        result.worst_chord = std::max(result.worst_chord, error);
    }
    return result;
}

// Bounds on a chord's error, in radii of the body and units of round-off u: `roundings` from computing the chord, and
// `place` per radius of distance from the eye, from its rounded start: sqrt(3) u off the surface, divided by the body's
// smallest half axis, times its longest chord. Chords of a box end on a plane, which the start does not affect.
struct ChordError {
    const char* shape;
    double roundings, place;
};
constexpr ChordError sphere_error{"sphere", 2 * 8, 2 * 1.7321};
constexpr ChordError ellipsoid_error{"ellipsoid", 3 * 16, 3 * 1.7321 / 0.75};
constexpr ChordError axis_box_error{"axis box", 4 * 4, 0};
constexpr ChordError oriented_box_error{"oriented box", 4 * 8, 0};
constexpr ChordError quad_error{"quad", 0, 0};  // a quad has no inside, so no ray has a chord in it

void add_rows(std::vector<Measurement>& rows, const ChordError& bound, const StartedRays& found, double distance) {
    const std::string shape = bound.shape;
    rows.push_back({.quantity = "rays off the " + shape + " that meet it again",
                    .measured = static_cast<double>(found.self_hits),
                    .tolerance = {0, 0, "numerics.md S15: none"}});
    if (bound.roundings > 0) {
        const double units = bound.roundings + bound.place * (distance + 1);
        rows.push_back({.quantity = "error of chords through the " + shape + ", radii",
                        .measured = found.inward > 0 ? found.worst_chord : 1,
                        .tolerance = {units * round_off(false), units * round_off(true),
                                      "counted roundings of the chord and of its start (numerics.md S15: 3e-7)"}});
    }
}

template <class Real, FeatureSet formula>
std::vector<Measurement> self_hits_in(const Values& v, const DirectSetting& setting) {
    const double radius = v["radius"];
    const Vec3d centre = Vec3d(2, 3, 6) * (v["distance"] * radius / 7);
    const Vec3d scale = Vec3d(2, 3, 1.5) * radius;
    const Vec3d turn(10, 20, 30);
    std::vector<Measurement> rows;
    const auto look_at = [&](const ChordError& bound, const auto& add_body, const auto& bodies_of) {
        SceneText text("self_hits");
        add_body(text, text.diffuse(Vec3d(0.5)));
        const RayScene<Real, formula> scene(text);
        const auto body = bodies_of(scene.view())[0];
        const int count = setting.is_quick ? 10000 : 200000;
        if constexpr (formula & static_cast<FeatureSet>(Feature::double_intersection)) {
            add_rows(rows, bound, start_rays(scene, widened(body), centre, radius, count), v["distance"]);
        } else {
            add_rows(rows, bound, start_rays(scene, body, centre, radius, count), v["distance"]);
        }
    };
    using Name = const std::string&;
    look_at(
        sphere_error, [&](SceneText& t, Name m) { t.sphere(m, centre, 2 * radius); },
        [](const auto& view) { return view.spheres; });
    look_at(
        ellipsoid_error, [&](SceneText& t, Name m) { t.ellipsoid(m, centre, scale, turn); },
        [](const auto& view) { return view.ellipsoids; });
    look_at(
        axis_box_error, [&](SceneText& t, Name m) { t.box(m, centre, scale); },
        [](const auto& view) { return view.axis_boxes; });
    look_at(
        oriented_box_error, [&](SceneText& t, Name m) { t.box(m, centre, scale, turn); },
        [](const auto& view) { return view.oriented_boxes; });
    look_at(
        quad_error, [&](SceneText& t, Name m) { t.quad(m, centre, scale.x, scale.z, turn); },
        [](const auto& view) { return view.quads; });
    return rows;
}

std::vector<Measurement> self_hits(const Values& v, const DirectSetting& setting) {
    return in_setting(setting,
                      [&]<class Real, FeatureSet formula>() { return self_hits_in<Real, formula>(v, setting); });
}

const CasesOf<Family::geometry> cases({
    {.name = "huge_sphere",
     .catalogue = "S13",
     .title = "the distance to a huge ground sphere below the eye",
     .stiff = "|f|^2 - R^2 cancels all but the eye's height over the radius of its digits",
     .formula = "c / (b + sqrt(b^2 - a c)) with c = h (2 R + h), in long double from the scene's numbers",
     .parameters = {{"radius", 1e5, 1, 1e9, "of the sphere, scene units"},
                    {"height", 1.3, 0.01, 100, "of the eye above it, scene units"}},
     .points = along("radius", {1, 1e3, 1e5, 1e6, 1e7}),
     .quick_points = along("radius", {1, 1e5, 1e7}),
     .sweep = "radius",
     .direct = huge_sphere,
     .direct_has_naive = true,
     .direct_has_mixed = true},
    {.name = "ground_view",
     .catalogue = "S13",
     .title = "a huge ground sphere seen through an absorbing medium, and its horizon",
     .stiff = "an error of the distance to the ground is one of the light that comes from it",
     .formula = "exp(-sigma t) with t from long double; the hyperbola that bounds the ground in the image",
     .parameters = {{"radius", 1e5, 100, 1e9, "of the sphere, scene units"},
                    {"height", 1.25, 0.01, 5, "of the eye above it, scene units"}},
     .points = along("radius", {1e2, 1e3, 1e5, 1e6, 1e7}),
     .quick_points = along("radius", {1e2, 1e5}),
     .sweep = "radius",
     .renderings = ground_view},
    {.name = "far_sphere",
     .catalogue = "S14",
     .title = "the disc of a distant unit sphere",
     .stiff = "b^2 and |f|^2 - 1 agree in all digits but the last ones from a distance of 1e4 on",
     .formula = "disc area pi / (D^2 - 1) over the image's area",
     .parameters = {{"distance", 1e4, 2, 1e6, "of its centre, radii"}},
     .points = along("distance", {10, 1e2, 1e3, 1e4, 1e5, 1e6}),
     .quick_points = along("distance", {1e2, 1e4}),
     .sweep = "distance",
     .renderings = [](const Values& v) { return far_sphere(v); }},
    {.name = "self_hits",
     .catalogue = "S15",
     .title = "rays that start on a body, of every shape",
     .stiff = "a fixed epsilon is a whole body at a radius of 1e-6 and below the spacing of numbers at 1e6",
     .formula = "no outward ray meets the body; a chord is -2 r n.d, or ends at the first plane ahead",
     .parameters = {{"radius", 1, 1e-6, 1e6, "of the sphere, scene units; the other bodies are alike"},
                    {"distance", 1, 0, 1e6, "of the bodies' centres from the eye, radii"}},
     .points = joined({along("radius", {1e-6, 1e-3, 1, 1e3, 1e6}),
                       table({"radius", "distance"}, {{1, 1e2}, {1, 1e4}})}),
     .quick_points = {{{"radius", 1e-6}}, {{"radius", 1}, {"distance", 1e4}}, {{"radius", 1e6}}},
     .sweep = "radius",
     .direct = self_hits,
     .direct_has_naive = true,
     .direct_has_mixed = true},
});

}  // namespace
}  // namespace pt::stability::geometry
