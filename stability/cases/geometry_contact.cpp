// Cases S16 to S19 and S22: surfaces that are grazed, touched by the eye, in contact, coincident, or nearly degenerate.
#include <algorithm>
#include <cmath>

#include "harness/scene/scene.h"
#include "harness/stability/case.h"

namespace pt::stability::geometry_contact {
namespace {

using Vec3l = Vec3<long double>;

// Returns a function that counts the pixels of an image whose index and radiance fulfil the condition.
template <class Condition>
std::function<double(const RenderResult&)> pixels_where(const Condition& counts) {
    return [counts](const RenderResult& result) {
        double count = 0;
        for (std::uint32_t i = 0; i < result.film.width() * result.film.height(); ++i) {
            count += counts(i, result.film.pixel(i).x) ? 1 : 0;
        }
        return count;
    };
}

// ---- Case S16: a quad of length 1 below the eye, whose far edge is seen `angle` degrees off its normal.

std::vector<Rendering> grazing(const Values& v) {
    constexpr std::uint32_t rows = 64;
    const long double slope = tanl((90 - static_cast<long double>(v["angle"])) * (pi<long double> / 180));
    const auto height = static_cast<double>(slope);
    const auto half = static_cast<double>(4 * slope);  // half the image's height, at distance 1
    const Rotation turn = rotation_of({v["tilt"], 0, 0});
    const auto turned = [&](double y, double z) { return turn.column[1] * y + turn.column[2] * z; };
    SceneText text("grazing");
    text.camera({0, 0, 0}, turned(0, 1), turned(1, 0)).image(4, rows, 2 * std::atan(half) * 180 / pi<double>, false);
    text.quad(text.emitter(Vec3d(0.5)), turned(-height, 0.5), 4, 1, {v["tilt"], 0, 0});
    // Counts the image rows whose pixel centres look at the quad: those below the image of the quad's far edge.
    double covered = 0;
    for (std::uint32_t row = 0; row < rows; ++row) {
        const double y = half * (1 - (2 * row + 1.0) / rows);
        covered += y < -height ? 1 : 0;
    }
    return {{.scene = text.json(),
             .quick_paths = 4 * rows,
             .full_paths = 64 * rows,
             .quantities = {
                 exactly("pixels that are neither black nor as bright as the quad",
                         pixels_where([](std::uint32_t, double x) { return x != 0 && x != 0.5; }), 0,
                         {0, 0, "numerics.md S16: exactly"}),
                 exactly("rows below the far edge", [](const RenderResult& r) { return mean_radiance(r) * rows / 0.5; },
                         covered, {1, 1, "numerics.md S16: one row"})}}};
}

// ---- Case S17: an eye on a surface.

// Counts the pixels on the wrong side of the plane through the eye with the normal `out`: pixels that look outwards
// must be white, all others black. Pixels whose cosine is below 2^-20 may be either.
std::function<double(const RenderResult&)> misjudged(const Vec3d& forward, const Vec3d& up, const Vec3d& out) {
    return [=](const RenderResult& result) {
        const std::uint32_t width = result.film.width(), height = result.film.height();
        const Vec3l ahead = normalize(Vec3l(forward));
        const Vec3l right = normalize(cross(ahead, Vec3l(up)));
        const Vec3l above = cross(right, ahead);
        return pixels_where([&](std::uint32_t i, double radiance) {
            const long double pixel = 2.0L / height;  // pixel size at distance 1, for a field of view of 90 degrees
            const long double x = (i % width + 0.5L - width / 2.0L) * pixel;
            const long double y = (i / width + 0.5L - height / 2.0L) * pixel;
            const long double cosine = dot(normalize(right * x - above * y + ahead), normalize(Vec3l(out)));
            return std::abs(cosine) >= 0x1p-20L && radiance != (cosine > 0 ? 1 : 0);
        })(result);
    };
}

Rendering touched(const std::string& name, SceneText text, const Vec3d& out) {
    constexpr std::uint32_t side = 64;
    // The camera looks along the surface, so that half of the image looks outwards.
    const Vec3d forward = std::abs(out.x) + std::abs(out.y) > 0 ? Vec3d(out.y, -out.x, 0) : Vec3d(1, 0, 0);
    text.camera({0, 0, 0}, forward, out).image(side, side, 90, false).environment(1);
    return {.scene = text.json(),
            .quick_paths = side * side,
            .full_paths = 4 * side * side,
            .quantities = {exactly("pixels on the wrong side, the eye on " + name, misjudged(forward, out, out), 0,
                                   {0, 0, "numerics.md S17: none with |d.n| >= 2^-20"})}};
}

std::vector<Rendering> eye_touches(const Values& v) {
    const double size = v["size"];
    std::vector<Rendering> renderings;
    {
        SceneText text("eye_touches");
        renderings.push_back(
            touched("a sphere", text.sphere(text.diffuse(Vec3d(0.0)), {0, -size, 0}, 2 * size), {0, 1, 0}));
    }
    {
        SceneText text("eye_touches");
        renderings.push_back(touched(
            "a box", text.box(text.diffuse(Vec3d(0.0)), {size / 8, size / 4, size}, Vec3d(2 * size)), {0, 0, -1}));
    }
    {
        SceneText text("eye_touches");
        renderings.push_back(
            touched("an ellipsoid", text.ellipsoid(text.diffuse(Vec3d(0.0)), {0, -size, 0}, {4 * size, 2 * size, size}),
                    {0, 1, 0}));
    }
    // One more rendering has its eye inside a lamp.
    SceneText text("eye_touches");
    text.image(16, 16, 120, true).sphere(text.emitter(Vec3d(0.75)), {size / 4, size / 2, -size / 8}, 2 * size);
    renderings.push_back(
        {.scene = text.json(),
         .quick_paths = 4096,
         .full_paths = 1u << 16,
         .quantities = {every_pixel_is("radiance inside of a lamp", 0.75, {0, 0, "numerics.md S17: exactly"})}});
    return renderings;
}

// An eye on the surface of a sphere whose radius has no exact inverse, in direction (2, 3, 6) / 7 from the centre.
std::vector<Rendering> eye_touches_at_slant(const Values& v) {
    const double size = v["size"];
    SceneText text("eye_at_slant");
    const Vec3d out(2, 3, 6);
    return {touched("a sphere", text.sphere(text.diffuse(Vec3d(0.0)), out * -size, 14 * size), out)};
}

// The known limit of an eye on an ellipsoid, in double: with a size that is a power of two, its position is exact.
std::string eye_on_ellipsoid(const Values& v, const VariantTraits& variant) {
    int exponent = 0;
    if (variant.precision.is_single() || std::frexp(v["size"], &exponent) == 0.5) {
        return "";
    }
    return "an eye on an ellipsoid to within rounding counts as inside where |f|^2 rounds to less than 1; cure: the "
           "eye's power formed at load, as spheres have it";
}

// ---- Case S18: surfaces in contact.

// A view that sees the same point in all pixels, which are enough to fill an integrator's queue.
SceneText& narrow_view(SceneText& text) { return text.image(16, 16, 1e-6, false); }

constexpr const char* contact_origin = "roundings of 1 - |p|^2 move the tangent by 4 u / 2 x: 16 u of the light";

// The radiance of a plane at distance x from its contact with a black unit sphere, under a white sky.
Rendering sphere_on_plane(double x, double albedo) {
    SceneText text("contact");
    text.camera({x + x * std::cos(x), x * std::sin(x), 0}, {x, 0, 0}).depth(2).environment(1);
    narrow_view(text);
    text.quad(text.diffuse(Vec3d(albedo)), {0, 0, 0}, 64, 64);
    text.sphere(text.diffuse(Vec3d(0.0)), {0, 1, 0}, 2);
    // The exact value is that of an endless plane. The quad has the same: it sees nothing below its own plane.
    const double exact = -albedo * std::expm1(-1.5 * std::log1p(x * x));
    return {.scene = text.json(),
            .quick_paths = 1u << 17,
            .quantities = {mean_is("radiance of the plane", exact,
                                   {16 * 0x1p-24 * albedo, 16 * 0x1p-53 * albedo + 0x1p-40, contact_origin})}};
}

// The cosine-weighted part of the hemisphere covered by a unit sphere that reaches below the horizon (numerics.md S8):
// centre at distance d, with the cosine w to the normal.
double covered_over_horizon(long double d, long double w) {
    const long double h2 = d * d;
    const long double k = sqrtl(1 - h2 * w * w);
    const long double root = sqrtl(h2 - 1);
    return static_cast<double>(((w * acosl(-w * root / sqrtl(1 - w * w)) - k * root) / h2 + atanl(k / root)) /
                               pi<long double>);
}

// The radiance of a unit sphere at the angle x from its contact with a black unit sphere, under a white sky.
Rendering sphere_on_sphere(double x, double albedo) {
    SceneText text("contact");
    const Vec3d point(std::sin(x), std::cos(x), 0), tangent(std::cos(x), -std::sin(x), 0);
    text.camera(point * (1 + 0.25 * x * x) + tangent * (0.5 * x), point).depth(2).environment(1);
    narrow_view(text);
    text.sphere(text.diffuse(Vec3d(albedo)), {0, 0, 0}, 2);
    text.sphere(text.diffuse(Vec3d(0.0)), {0, 2, 0}, 2);
    const long double cosine = cosl(static_cast<long double>(x));
    const long double d = sqrtl(5 - 4 * cosine);
    const double exact = albedo * (1 - covered_over_horizon(d, (2 * cosine - 1) / d));
    return {.scene = text.json(),
            .quick_paths = 1u << 17,
            .quantities = {mean_is("radiance of the lower sphere", exact,
                                   {16 * 0x1p-24 * albedo, 16 * 0x1p-53 * albedo + 0x1p-40, contact_origin})}};
}

// An image of a sphere on a plane from afar, which must be darker everywhere than under the open sky.
Rendering contact_image(double albedo) {
    SceneText text("contact");
    text.camera({0, 1, -4}, {0, 0.5, 0}).image(32, 32, 50, true).depth(2).environment(1);
    text.quad(text.diffuse(Vec3d(albedo)), {0, 0, 0}, 1024, 1024);
    text.box(text.diffuse(Vec3d(albedo)), {0, 512, 20}, {1024, 1024, 1});
    text.sphere(text.diffuse(Vec3d(0.0)), {0, 1, 0}, 2);
    const auto brightest = [](const RenderResult& result) {
        double most = 0;
        for (std::uint32_t i = 0; i < result.film.width() * result.film.height(); ++i) {
            most = std::max(most, result.film.pixel(i).x);
        }
        return most;
    };
    return {.scene = text.json(),
            .quick_paths = 1u << 14,
            .full_paths = 1u << 20,
            .quantities = {{.name = "brightest pixel",
                            .of = brightest,
                            .exact = albedo,
                            .tolerance = {0, 0, "numerics.md S18: none above the open sky"},
                            .relation = Relation::at_most,
                            .is_estimate = false}}};
}

// ---- Case S19: two coincident quads. The quad whose material comes first in the file has the lower object number.

std::vector<Rendering> coincident(const Values& v) {
    std::vector<Rendering> renderings;
    for (const bool reflects : {false, true}) {
        SceneText text("coincident");
        text.image(16, 16, 40, true).depth(2).environment(reflects ? 1 : 0);
        for (const double value : {0.25, 0.75}) {
            const std::string material = reflects ? text.diffuse(Vec3d(value)) : text.emitter(Vec3d(value));
            text.quad(material, {0, 0, 4}, 8, 8, {90 - v["tilt"], v["tilt"] / 2, 0});
        }
        renderings.push_back(
            {.scene = text.json(),
             .quick_paths = 1u << 14,
             .full_paths = 1u << 20,
             .quantities = {every_pixel_is(reflects ? "light reflected by one of two quads in one place"
                                                    : "light emitted by one of two quads in one place",
                                           0.25, {0, 0, "numerics.md S19: exactly one of the two"})}});
    }
    return renderings;
}

std::string coincident_limit(const Values& v, const VariantTraits&) {
    if (v["tilt"] == 0) {
        return "";
    }
    return "a path leaves one quad from a point that rounding put off the plane of both, and may meet the other; "
           "no cure without knowing that they are one: put surfaces apart, or make them one object";
}

// ---- Case S22: bodies of almost no size in a furnace of the same material.

std::vector<Rendering> degenerate(const Values& v) {
    constexpr std::uint32_t depth = 32;
    const double thin = v["thickness"];
    SceneText text("degenerate");
    text.camera({0.25, 0.5, -0.125}, {0.5, -0.25, 1}).image(8, 8, 90, true).depth(depth);
    const std::string wall = text.diffuse(Vec3d(0.5), Vec3d(0.5));
    text.sphere(wall, {0, 0, 0}, 4);
    text.sphere(wall, {0.5, 0.25, 0.5}, thin);
    const double thinnest = std::max(thin, 1e-12);  // scene files limit the ratio of an ellipsoid's axes
    text.ellipsoid(wall, {0, 0, 0.5}, {thinnest, 1, 1}, {10, 20, 30});
    text.ellipsoid(wall, {0.5, 0, 0}, {thinnest, 1, thinnest});
    text.box(wall, {0, -0.5, 0}, {1, thin, 1}).box(wall, {-0.5, 0, 0}, {thin, thin, 1});
    text.box(wall, {0.5, -0.25, 0.75}, {1, thin, 1}, {10, 20, 30}).box(wall, {0.5, 0, 0.25}, Vec3d(thin), {5, 6, 7});
    text.quad(wall, {0, 0.25, 0.75}, thin, 1).quad(wall, {0.25, 0, 0.75}, thin, thin, {10, 20, 30});
    const double exact = 1 - std::exp2(-static_cast<double>(depth));
    return {{.scene = text.json(),
             .quick_paths = 1u << 14,
             .full_paths = 1u << 20,
             .quantities = {every_pixel_is("radiance of the pixel that is farthest off", exact,
                                           {1e-6, 1e-12, "numerics.md S1, and the film's quantum"}),
                            exactly("segments missing of a path", missing_segments(depth), 0,
                                    {0, 0, "a closed space loses no path"})}}};
}

const CasesOf<Family::geometry> cases({
    {.name = "grazing",
     .catalogue = "S16",
     .title = "a quad seen along its plane",
     .stiff = "the distance is a quotient of two numbers that are next to nothing",
     .formula = "L = L_e on every covered pixel; rows below atan(h / length)",
     .parameters = {{"angle", 89.99, 10, 89.9999, "of view off the normal at the far edge, degrees"},
                    {"tilt", 0, -180, 180, "of the stage, degrees"}},
     .points = {{{"angle", 89.9}}, {{"angle", 89.99}}, {{"angle", 89.999}}, {{"angle", 89.999}, {"tilt", 33}}},
     .quick_points = {{{"angle", 89.9}}, {{"angle", 89.999}, {"tilt", 33}}},
     .sweep = "angle",
     .renderings = grazing},
    {.name = "eye_touches",
     .catalogue = "S17",
     .title = "an eye exactly on a body, and one inside of a lamp",
     .stiff = "the first root is exactly 0: hit, missed or behind is decided by its sign",
     .formula = "1 for d.n > 0, 0 for d.n < 0; L_e inside of a lamp",
     .parameters = {{"size", 1, 1e-9, 1e9, "of the bodies, scene units"}},
     .points = along("size", {1, 0x1p-20, 0x1p20, 1e-6, 1e6}),
     .quick_points = along("size", {1, 1e-6}),
     .sweep = "size",
     .renderings = eye_touches,
     .known_limit = eye_on_ellipsoid},
    {.name = "eye_touches_slant",
     .catalogue = "S17",
     .title = "an eye on a sphere, off its axes",
     .stiff = "|f|^2 - 1 is 0, but of rounded squares: its sign is that of a rounding",
     .formula = "1 for d.n > 0, 0 for d.n < 0",
     .parameters = {{"size", 1, 1e-6, 1e5, "a seventh of the radius, scene units"}},
     .points = along("size", {1, 0.001}),
     .renderings = eye_touches_at_slant},
    {.name = "contact",
     .catalogue = "S18",
     .title = "a sphere on a plane and on a sphere, near the contact",
     .stiff = "light comes to the contact by a wedge as thin as x^2, between surfaces that shut it",
     .formula = "rho (1 - (1 + x^2)^(-3/2)); the sphere over the horizon of numerics.md S8 with d^2 = 5 - 4 cos x",
     .parameters = {{"x", 0.25, 0.01, 1, "from the contact, radii"}, {"albedo", 0.5, 0, 1, "of the lower surface"}},
     .points = along("x", {1, 0.25, 0.05, 0.01}),
     .quick_points = {{{"x", 0.25}}},
     .sweep = "x",
     .renderings =
         [](const Values& v) {
             return std::vector{sphere_on_plane(v["x"], v["albedo"]), sphere_on_sphere(v["x"], v["albedo"]),
                                contact_image(v["albedo"])};
         }},
    {.name = "coincident",
     .catalogue = "S19",
     .title = "two quads in one place",
     .stiff = "both are met at the same distance: which one counts is decided by order, or by rounding",
     .formula = "the quad with the lower number, in every pixel",
     .parameters = {{"tilt", 0, 0, 80, "of the quads, degrees"}},
     .points = along("tilt", {0, 20}),
     .renderings = coincident,
     .known_limit = coincident_limit},
    {.name = "degenerate",
     .catalogue = "S22",
     .title = "needles, plates and specks in a furnace of the same material",
     .stiff = "inverses of next to nothing, entries and exits at one distance, normals of no length",
     .formula = "E (1 - rho^D) / (1 - rho) as without them, and no path lost",
     .parameters = {{"thickness", 1e-6, 1e-18, 0.25, "of the bodies, scene units"}},
     .points = along("thickness", {1e-18, 1e-12, 1e-6, 0.01}),
     .quick_points = along("thickness", {1e-18, 1e-6}),
     .sweep = "thickness",
     .renderings = degenerate},
});

}  // namespace
}  // namespace pt::stability::geometry_contact
