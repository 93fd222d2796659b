// Cases S6 to S10: a diffuse receiver under lights of known irradiance.
#include <cmath>

#include "kernels/naive.h"
#include "stability/cases/receiver.h"
#include "stability/oracles/limits.h"

namespace pt::stability::irradiance {
namespace {

std::vector<Rendering> rectangle(const Values& v) {
    const double a = v["a"], b = v["b"], h = v["h"];
    SceneText scene = receiver("rectangle", 0.5 * h);
    const bool centred = v.is_set("centred");
    scene.quad(scene.emitter(Vec3d(1.0)), {centred ? 0 : 0.5 * a, h, centred ? 0 : 0.5 * b}, a, b, {180, 0, 0});
    const double irradiance = centred ? 4 * rectangle_irradiance(0.5 * a, 0.5 * b, h) : rectangle_irradiance(a, b, h);
    return lit(scene, irradiance, {1e-5, 1e-12, "numerics.md S6"});
}

std::vector<Rendering> disk(const Values& v) {
    const double r = v["r"], h = v["h"], offset = v["offset"], flatness = v["flatness"];
    SceneText scene = receiver("disk", 0.25 * h);
    scene.ellipsoid(scene.emitter(Vec3d(1.0)), {offset, h, 0}, {2 * r, 2 * h * flatness, 2 * r});
    // In units of the lamp's half axes, the receiver is h / (half thickness) away, which magnifies rounding errors.
    return lit(scene, flat_ellipsoid_irradiance(r, h * flatness, h, offset),
               {1e-5 + 0x1p-22 / flatness, 1e-12 + 0x1p-51 / flatness,
                "numerics.md S7, and four roundings of the distance in half thicknesses"});
}

// Camera height: half way up the normal to the lamp's sphere or, if that is far or missed, half way to its centre.
double height_within_gap(double distance, double angle) {
    const double b = distance * std::cos(angle), discriminant = b * b - (distance * distance - 1);
    double gap = std::max(distance, 1.0);
    if (discriminant > 0) {
        const double root = std::sqrt(discriminant);
        const double first = b - root > 0 ? b - root : b + root;
        gap = first > 0 ? std::min(gap, first) : gap;
    }
    return 0.5 * gap;
}

std::vector<Rendering> sphere(const Values& v) {
    const double distance = v["distance"], angle = v["angle"];
    SceneText scene = receiver("sphere_light", height_within_gap(distance, angle));
    scene.sphere(scene.emitter(Vec3d(1.0)), {distance * std::sin(angle), distance * std::cos(angle), 0}, 2);
    const double irradiance = sphere_irradiance(distance, angle);
    // How much the irradiance changes by a rounding of the lamp's centre, which changes its distance.
    const double step = 0x1p-20 * distance;
    const double slope =
        std::abs(sphere_irradiance(distance + step, angle) - sphere_irradiance(distance - step, angle)) / (2 * step);
    const double moved = distance > 1 + step && irradiance > 0 ? slope * distance / irradiance : 0;
    return lit(scene, irradiance,
               {1e-5 + 0x1p-23 * moved, 1e-12 + 0x1p-52 * moved,
                "numerics.md S6 and S8, and a rounding of the sphere's distance"});
}

// Case S9: sample_direction of a narrow cone. Errors are relative, so that a figure shows the number of correct digits.
template <class Real>
std::vector<Measurement> cone(double sine_squared, bool is_naive) {
    const auto radius = static_cast<Real>(std::sqrt(sine_squared));
    const Sphere<Real> sphere{{Real(0), Real(1), Real(0)}, radius, Real(1) / radius};
    const Vec3<Real> observer(Real(0));
    const long double s2 = static_cast<long double>(radius) * radius;
    const long double one_minus_cosine = s2 / (1 + std::sqrt(1 - s2));
    const long double solid_angle = 2 * pi<long double> * one_minus_cosine;
    long double irradiance = 0;
    double widest = 0;
    constexpr int steps = 64;
    Real measure = Real(0);
    for (int i = 0; i < steps * steps; ++i) {
        const Real u = (static_cast<Real>(i % steps) + Real(0.5)) / steps;
        const Real w = (static_cast<Real>(i / steps) + Real(0.5)) / steps;
        const DirectionSample<Real> sample = is_naive ? naive::sample_direction(sphere, observer, u, w, Real(0.5))
                                                      : sample_direction(sphere, observer, u, w, Real(0.5));
        measure = sample.inverse_pdf;
        const Vec3<double> d(sample.direction);
        irradiance += static_cast<long double>(d.y) * sample.inverse_pdf / (steps * steps);
        widest = std::max(widest, std::sqrt((d.x * d.x + d.z * d.z) / dot(d, d) / static_cast<double>(s2)));
    }
    const auto ratio = [](long double a, long double b) { return static_cast<double>(a / b); };
    const long double below = one_minus_cosine * (1 - 0.5L / steps);  // 1 - cosine of the widest direction sampled
    const Tolerance digits{1e-6, 1e-14, "numerics.md S9: 1e-6 in single precision; 64 roundings in double"};
    return {{.quantity = "solid angle over its exact value",
             .measured = ratio(measure, solid_angle),
             .exact = 1,
             .tolerance = digits},
            {.quantity = "irradiance over its exact value",
             .measured = ratio(irradiance, pi<long double> * s2),
             .exact = 1,
             .tolerance = digits},
            {.quantity = "sine of the widest direction over the cone's, of 64 x 64 directions",
             .measured = widest,
             .exact = ratio(std::sqrt(below * (2 - below)), std::sqrt(s2)),
             .tolerance = digits}};
}

std::vector<Measurement> far_light(const Values& v, const DirectSetting& setting) {
    const double sine_squared = std::pow(10.0, v["log10_sine_squared"]);
    return setting.precision.is_double() ? cone<double>(sine_squared, setting.is_naive)
                                         : cone<float>(sine_squared, setting.is_naive);
}

std::vector<Rendering> far_light_image(const Values& v) {
    const double sine = std::sqrt(std::pow(10.0, v["log10_sine_squared"]));
    SceneText scene = receiver("far_light", 0.5);
    scene.sphere(scene.emitter(Vec3d(1.0)), {0, 1, 0}, 2 * sine);
    return lit(scene, sphere_irradiance(1 / sine, 0), {1e-5, 1e-12, "numerics.md S9 and S5"});
}

// A receiver under two spherical lamps of the same irradiance; the far one is distance^2 times as bright.
std::vector<Rendering> two_lights(const Values& v) {
    constexpr double radius = 0.25, angle = 0.5;
    const double far = v["distance"];
    SceneText scene = receiver("two_lights", 0.25);
    const Vec3d near_centre(std::sin(angle), std::cos(angle), 0);
    scene.sphere(scene.emitter(Vec3d(1.0)), near_centre, 2 * radius);
    scene.sphere(scene.emitter(Vec3d(far * far)), Vec3d(-near_centre.x, near_centre.y, 0) * far, 2 * radius);
    return lit(scene, 2 * sphere_irradiance(1 / radius, angle), {1e-5, 1e-12, "numerics.md S10"});
}

// The known limit of a receiver straight below a quad's corner: the quad is widened by some roundings at its edges.
std::string wide_edges(const Values& v, const VariantTraits& variant) {
    const double reach = 0x1p-20 * (v["h"] + 0.5 * (v["a"] + v["b"]));
    const bool is_met = variant.direct_light.counts_light_met && variant.precision.is_single();
    return is_met && !v.is_set("centred") && reach > 1e-6 * v["h"]
               ? "a quad is met up to 16 roundings of its size beyond its edges, so that none leak between two: near "
                 "it "
                 "that is an angle; cure: precision=double_intersection, or direct_light=nee"
               : "";
}

const CasesOf<Family::irradiance> cases({
    {.name = "rectangle",
     .catalogue = "S6",
     .title = "a rectangle straight above the receiver",
     .stiff = "a light nearly on the surface: weights of 1 / distance^2 have no bound, and heights cancel",
     .formula = "1/2 [A/sqrt(1+A^2) atan(B/sqrt(1+A^2)) + B/sqrt(1+B^2) atan(A/sqrt(1+B^2))], A = a/h, B = b/h",
     .parameters = {{"a", 1, 1e-3, 1e3, "one side, scene units"},
                    {"b", 1, 1e-3, 1e3, "the other side, scene units"},
                    {"h", 1, 1e-9, 1e3, "height, scene units"},
                    {"centred", 0, 0, 1, "0: a corner above the point, 1: the centre", true}},
     .points = {{{"h", 1}},
                {{"a", 2}, {"h", 0.5}},
                {{"a", 0.1}, {"b", 0.1}},
                {{"a", 2}, {"b", 2}, {"centred", 1}},
                {{"h", 1e-3}},
                {{"h", 1e-5}},
                {{"h", 1e-7}}},
     .quick_points = along("h", {1, 1e-3, 1e-7}),
     .sweep = "h",
     .estimators = {{axes::direct_light, {"nee", "nee_mis"}}},
     .renderings = rectangle,
     .known_limit = wide_edges},
    {.name = "disk",
     .catalogue = "S7",
     .title = "a disk above the receiver, or beside it: a flattened ellipsoid",
     .stiff = "an ellipsoid so flat that its own frame is stretched 64 times and more in one direction",
     .formula = "pi/2 [1 - (h^2+o^2-r^2)/sqrt((h^2+o^2+r^2)^2 - 4 o^2 r^2)] of a disk; of the ellipsoid, Lambert's "
                "contour integral along its outline",
     .parameters = {{"r", 1, 1e-3, 1e3, "radius, scene units"},
                    {"h", 1, 1e-3, 1e3, "height, scene units"},
                    {"offset", 0, 0, 1e3, "of the centre to the side, scene units"},
                    {"flatness", 0x1p-6, 0x1p-16, 0.5, "half the thickness over the height"}},
     .points = {{{"r", 1}},
                {{"offset", 1}},
                {{"r", 0.5}, {"h", 2}, {"offset", 3}},
                {{"h", 0.1}, {"offset", 0.9}},
                {{"flatness", 0x1p-10}},
                {{"flatness", 0x1p-14}}},
     .quick_points = {{{"offset", 1}}, {{"flatness", 0x1p-10}}},
     .sweep = "flatness",
     .estimators = {{axes::direct_light, {"nee", "nee_mis"}}},
     .renderings = disk},
    {.name = "sphere_light",
     .catalogue = "S8",
     .title = "a sphere above the receiver, across its horizon, almost on it, and around it",
     .stiff =
         "a gap of 1e-4 radii between receiver and light, and a cone wider than the hemisphere: sin^2 > 1 is a NaN",
     .formula = "pi (R/d)^2 cos w above the horizon; across it, Snyder's formula; pi from within",
     .parameters = {{"distance", 2, 0, 1e3, "of the centre, in radii"},
                    {"angle", 0, 0, 3, "of the centre off the normal, radians"}},
     .points = joined({along("angle", {0, 1.3707963267948966, 1.5707963267948966, 1.8707963267948966}),
                       table({"distance", "angle"}, {{1.0001, 0.3}, {0.5, 0.3}}), along("distance", {0})}),
     .quick_points = {{{"angle", 1.5707963267948966}},
                      {{"distance", 1.0001}, {"angle", 0.3}},
                      {{"distance", 0.5}, {"angle", 0.3}}},
     .sweep = "angle",
     .estimators = {{axes::direct_light, {"nee", "nee_mis"}}},
     .renderings = sphere,
     .known_limit =
         [](const Values& v, const VariantTraits& variant) {
             const double irradiance = sphere_irradiance(v["distance"], v["angle"]);
             return rare_or_dim(variant, irradiance, 1, irradiance);
         }},
    {.name = "far_light",
     .catalogue = "S9",
     .title = "the cone of directions towards a tiny light",
     .stiff = "1 - cos of the cone has no digit left in single precision below sin^2 = 6e-8: its density is infinite",
     .formula = "2 pi sin^2 / (1 + cos), and E = pi sin^2",
     .parameters = {{"log10_sine_squared", -8, -30, -0.1, "of the cone's half angle"}},
     .points = along("log10_sine_squared", {-1, -4, -6, -7.3, -8.497, -12, -20}),
     .quick_points = along("log10_sine_squared", {-1, -8.497, -20}),
     .sweep = "log10_sine_squared",
     .direct = far_light,
     .direct_has_naive = true},
    {.name = "far_light_image",
     .catalogue = "S9",
     .title = "a receiver lit by a tiny light alone",
     .stiff = "all the light comes by one path in 1 / sin^2, and all samples of a connection are alike",
     .formula = "E = pi sin^2",
     .parameters = {{"log10_sine_squared", -2, -16, -0.5, "of the light's half angle"}},
     .points = along("log10_sine_squared", {-2, -4, -6, -8.497}),
     .sweep = "log10_sine_squared",
     .estimators = {{axes::direct_light, {"nee", "nee_mis"}}},
     .renderings = far_light_image,
     .known_limit =
         [](const Values& v, const VariantTraits& variant) {
             const double share = std::pow(10.0, v["log10_sine_squared"]);
             return rare_or_dim(variant, share, 1, receiver_albedo * share);
         }},
    {.name = "two_lights",
     .catalogue = "S10",
     .title = "two lights of one irradiance, one of them far and bright",
     .stiff = "densities that differ by distance^2, up to 1e12, in one sum and in one weight",
     .formula = "twice pi (R/d)^2 cos w",
     .parameters = {{"distance", 10, 1, 1e7, "of the far light over that of the near one"}},
     .points = along("distance", {1, 10, 100, 1e3, 1e6}),
     .quick_points = along("distance", {1, 10}),
     .sweep = "distance",
     .estimators = {{axes::direct_light, {"nee", "nee_mis"}}},
     .renderings = two_lights,
     .known_limit =
         [](const Values& v, const VariantTraits& variant) {
             const double brightness = v["distance"] * v["distance"];
             return rare_or_dim(variant, 1 / (16 * brightness), brightness, 0.08);
         }},
});

}  // namespace
}  // namespace pt::stability::irradiance
