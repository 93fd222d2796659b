// Cases S43 and S45 to S48: the film's sums, and the camera's pixel, lens and shutter.
#include <cmath>

#include "harness/render/film.h"
#include "harness/scene/scene_buffers.h"
#include "kernels/intersect.h"
#include "stability/oracles/furnace.h"

namespace pt::stability::film {
namespace {

// The value of sample i that the case film_sum adds to the film, by the case's parameter `content`.
double sample_value(std::uint32_t content, std::uint32_t i) {
    const double u = unit_interval<double>(pcg4d({i, 43, 0, 0}).x);
    switch (content) {
        case 0:
            return 0.1;
        case 1:
            return 1;
        case 2:
            return u;
        case 3:
            return pcg4d({i, 43, 1, 0}).x < 42950u ? 1e5 : 0.18 * u;  // a random one in 1e5 samples has the value 1e5
        default:
            return i == 0 ? 1e6 : 1e-3 * u;
    }
}

template <class Kernel>
double film_over_exact(std::uint32_t content, std::uint64_t samples) {
    using Real = typename Kernel::Real;
    const double bounds[] = {0.1, 1, 1, 1e5, 1e6};
    Film film(1, 1, bounds[content], samples);
    const FilmView view = film.view();
    PixelSum<Kernel> sum;
    long double exact = 0;
    for (std::uint32_t i = 0; i < samples; ++i) {
        const auto value = static_cast<Real>(sample_value(content, i));
        sum.add(view, Vec3<Real>(value));
        exact += static_cast<long double>(value);
    }
    sum.finish(view, 0);
    return static_cast<double>(static_cast<long double>(film.pixel(0).x) * static_cast<long double>(samples) / exact);
}

std::vector<Measurement> film_sum(const Values& v, const DirectSetting& setting) {
    constexpr FeatureSet naive = no_features | Feature::naive;
    const std::uint32_t content = v.whole("content");
    const auto samples = static_cast<std::uint64_t>(v["samples"]);
    const bool fp64 = setting.precision.is_double();
    const double ratio = setting.is_naive ? (fp64 ? film_over_exact<Config<double, naive>>(content, samples)
                                                  : film_over_exact<Config<float, naive>>(content, samples))
                                          : (fp64 ? film_over_exact<Config<double, no_features>>(content, samples)
                                                  : film_over_exact<Config<float, no_features>>(content, samples));
    return {{.quantity = "mean over the samples' exact mean",
             .measured = ratio,
             .exact = 1,
             .tolerance = {1e-7, 1e-7, "numerics.md S43: the result is stored in single precision"}}};
}

// Case S45: how far samples lie outside their pixel, and their mean position.
template <class Real>
std::vector<Measurement> jitter(std::uint32_t width, std::uint32_t x, std::uint32_t samples) {
    Camera<Real> camera{};
    camera.right = {Real(1), Real(0), Real(0)};
    camera.up = {Real(0), Real(1), Real(0)};
    camera.forward = {Real(0), Real(0), Real(1)};
    camera.pixel_size = Real(2) / static_cast<Real>(width);  // makes the camera's field of view 90 degrees
    camera.width = width;
    camera.height = 1;
    camera.jitter = 1;
    camera.initial_medium = Path<Real>::no_medium;
    const RandomSeed seed = RandomSeed::from(45);
    long double sum = 0;
    long double farthest = 0;
    for (std::uint32_t i = 0; i < samples; ++i) {
        const Path<Real> path =
            camera_path<Config<Real, no_features | Feature::jitter>>(camera, seed, PixelPlace::of(x, width), i, i);
        const long double at = static_cast<long double>(path.direction.x) / path.direction.z / camera.pixel_size;
        const long double in_pixel = at + width * 0.5L - x;
        sum += in_pixel;
        farthest = std::max({farthest, -in_pixel, in_pixel - 1});
    }
    const double rounding = 0.5 * width * std::numeric_limits<Real>::epsilon();
    const std::string origin = "two roundings of the distance from the image's centre, and two of the direction";
    const Tolerance tolerance{2 * rounding, 2 * rounding, origin};
    return {{.quantity = "farthest outside of the pixel, pixels",
             .measured = static_cast<double>(farthest),
             .exact = 0,
             .relation = Relation::at_most,
             .tolerance = tolerance},
            {.quantity = "mean place in the pixel",
             .measured = static_cast<double>(sum / samples),
             .exact = 0.5,
             .standard_error = 1 / std::sqrt(12.0 * samples),
             .tolerance = tolerance}};
}

std::vector<Measurement> pixel_jitter(const Values& v, const DirectSetting& setting) {
    const std::uint32_t width = v.whole("width");
    const std::uint32_t x = std::min(width - 1, v.whole("x"));
    const std::uint32_t samples = setting.is_quick ? 1u << 20 : 1u << 24;
    return setting.precision.is_double() ? jitter<double>(width, x, samples) : jitter<float>(width, x, samples);
}

SceneText still_life(const std::string& name) {
    SceneText scene(name);
    scene.camera({0, 1, -4}, {0, 0, 0}).image(16, 16, 60, true).depth(4).environment(0.5);
    scene.sphere(scene.mirror(Vec3d(0.75)), {0, 0, 0}, 1.5);
    scene.quad(scene.diffuse({0.75, 0.5, 0.25}), {0, -0.75, 0}, 8, 8);
    return scene;
}

std::vector<Twins> closed_lens(const Values& v) {
    return {{.change = "an aperture of 0",
             .reference = still_life("lens_closed").json(),
             .changed = still_life("lens_closed").lens(0, v["focus"]).json()}};
}

std::vector<Twins> still_shutter(const Values&) {
    return {{.change = "a shutter open for a second before objects at rest",
             .reference = still_life("motion_zero").json(),
             .changed = still_life("motion_zero").shutter(0, 1, true).json()},
            {.change = "a moving object before a shutter open for no time",
             .reference = still_life("motion_zero").json(),
             .changed = still_life("motion_zero").velocity({3, 2, 1}).json()}};
}

Quantity coverage(double exact, const Tolerance& tolerance) {
    return mean_is("share that is covered", exact, tolerance);
}

Rendering one_segment(const SceneText& scene, const Quantity& quantity) {
    return {.scene = scene.json(), .quick_paths = 1u << 20, .full_paths = 1u << 25, .quantities = {quantity}};
}

// The share of a unit disc that lies to the left of x.
double disc_share(double x) {
    return x <= -1 ? 0 : x >= 1 ? 1 : 1 - (std::acos(x) - x * std::sqrt(1 - x * x)) / pi<double>;
}

// An emitting wall at depth z, seen through a lens: the wall's edge lies x radii of the blur disc from the axis.
std::vector<Rendering> lens_edge(const Values& v) {
    const double blur = v["aperture"] * std::abs(v["z"] - v["focus"]) / v["focus"];
    const double side = 8 * blur;
    SceneText scene("lens_edge");
    scene.lens(v["aperture"], v["focus"]);
    scene.quad(scene.emitter(Vec3d(1.0)), {v["x"] * blur - 0.5 * side, 0, v["z"]}, side, side, {90, 0, 0});
    const double exact = disc_share(v["x"]);
    const double reach = (v["z"] + side) / blur * 2 / pi<double>;
    return {one_segment(scene, coverage(exact, {1e-5 * exact + 0x1p-19 * reach, 1e-12 * exact + 0x1p-48 * reach,
                                                "a quad's edge reaches out by 16 roundings, and its place has 16"}))};
}

// An emitting box that covers [0, width] at time 0 and moves at speed v, seen at x through a shutter of 1 second.
SceneText moving_box(const Values& v) {
    SceneText scene("motion");
    scene.camera({v["x"], 0, 0}, {v["x"], 0, 1}).shutter(0, 1, v.is_set("late"));
    scene.box(scene.emitter(Vec3d(1.0)), {0.5 * v["width"], 0, 5}, {v["width"], 1, 1}).velocity({v["v"], 0, 0});
    return scene;
}

double moving_box_coverage(const Values& v) {
    const double from = std::clamp((v["x"] - v["width"]) / v["v"], 0.0, 1.0), to = std::min(1.0, v["x"] / v["v"]);
    return v.is_set("late") ? (to - from) * (to + from) : to - from;
}

// Error of moving_box_coverage in roundings, which comes from the times at which the two ends of the box pass.
double moving_box_rounding(const Values& v) {
    const double at = std::min(1.0, v["x"] / v["v"]);
    return 4 * at * (1 + at);
}

std::vector<Rendering> motion(const Values& v) {
    const double exact = moving_box_coverage(v);
    const double rounding = moving_box_rounding(v);
    return {one_segment(moving_box(v),
                        coverage(exact, {0x1p-23 + 0x1p-24 * rounding, 0x1p-31 + 0x1p-53 * rounding,
                                         "the steps of the random numbers, and the roundings of time and way"}))};
}

template <class Kernel>
double grid_coverage(const Scene& scene) {
    using Real = typename Kernel::Real;
    constexpr std::uint32_t steps = 1u << 24;
    const SceneBuffers<Real> buffers(scene, default_settings(scene));
    const SceneView<Real>& view = buffers.view();
    std::uint32_t hits = 0;
    for (std::uint32_t i = 0; i < steps; ++i) {
        const Real u = static_cast<Real>(i) * Real(0x1p-24);
        const Real time = view.camera.shutter_open +
                          view.camera.shutter_length * (view.camera.shutter_late != 0 ? square_root(u) : u);
        hits += closest_hit<Kernel>(view, Ray<Real>{Vec3<Real>(Real(0)), view.camera.forward, time, {}}).side.exists();
    }
    return static_cast<double>(hits) / steps;
}

std::vector<Measurement> motion_grid(const Values& v, const DirectSetting& setting) {
    constexpr FeatureSet plain = Feature::axis_box | Feature::motion;
    constexpr FeatureSet naive = plain | Feature::naive;
    constexpr FeatureSet mixed = plain | Feature::double_intersection;
    const Scene scene = parse_scene(moving_box(v).json().dump(), "stability case motion_grid");
    const bool fp64 = setting.precision.is_double();
    const double measured = setting.precision.is_mixed() ? grid_coverage<Config<float, mixed>>(scene)
                            : setting.is_naive           ? (fp64 ? grid_coverage<Config<double, naive>>(scene)
                                                                 : grid_coverage<Config<float, naive>>(scene))
                            : fp64                       ? grid_coverage<Config<double, plain>>(scene)
                                                         : grid_coverage<Config<float, plain>>(scene);
    const double rounding = moving_box_rounding(v);
    return {{.quantity = "share of 2^24 moments at which the box is met",
             .measured = measured,
             .exact = moving_box_coverage(v),
             .tolerance = {0x1p-23 + 0x1p-24 * rounding, 0x1p-23 + 0x1p-53 * rounding,
                           "a moment at both ends, and the roundings of time and way"}}};
}

// A quad's edge runs along a column of pixels, at one place in all of them; another quad's edge crosses one pixel.
std::vector<Rendering> pixel_edge(const Values& v) {
    constexpr std::uint32_t rows = 64;
    const double share = v["share"];
    const double pixel = 2.0 / rows;  // height of a pixel at distance 1, for a field of view of 90 degrees
    const Tolerance tolerance{0x1p-24 + 0x1p-18 * rows, 0x1p-32 + 0x1p-47 * rows,
                              "the steps of the random numbers, and a quad's edge that reaches out by 16 roundings"};
    SceneText column("pixel_edge");
    column.image(1, rows, 90, true);
    column.quad(column.emitter(Vec3d(1.0)), {(share - 0.5) * pixel - 2, 0, 1}, 4, 4, {90, 0, 0});
    Rendering upright = one_segment(column, coverage(share, tolerance));
    // The pixels' variance is taken about their own mean, since the widened edge of the quad shifts all pixels alike.
    const auto variance = [](const RenderResult& result) {
        const double mean = mean_radiance(result);
        double squares = 0;
        for (std::uint32_t i = 0; i < rows; ++i) {
            squares += std::pow(result.film.pixel(i).x - mean, 2);
        }
        return squares / (rows - 1) * static_cast<double>(result.film.samples());
    };
    upright.quantities.push_back({.name = "variance of a sample, from that of the pixels",
                                  .of = variance,
                                  .exact = share * (1 - share),
                                  .tolerance = tolerance});
    SceneText single("pixel_edge_level");
    single.image(1, 1, 90, true);
    single.quad(single.emitter(Vec3d(1.0)), {0, 2 * share - 1 - 2, 1}, 4, 4, {90, 0, 0});
    return {upright, one_segment(single, coverage(share, tolerance))};
}

std::string rarely_passed(const Values& v, const VariantTraits&) {
    return moving_box_coverage(v) * 0x1p20 < 100
               ? "too few samples see the box pass for an error to be told; cure: more samples, or motion_grid"
               : "";
}

std::string coarse_film(const Values& v, const VariantTraits&) {
    return v["content"] == 4
               ? "the film's quantum is 2^-32 of the brightest sample or more: nearly all samples here are "
                 "of a few quanta, and their rounding has a mean; cure: rounding by a random number of the "
                 "sample's own"
               : "";
}

const std::vector<Parameter> motion_parameters{
    {"v", 100, 1e-3, 1e9, "of the box, scene units a second"},
    {"width", 1, 1e-3, 1e9, "of the box, scene units"},
    {"x", 24, 0, 1e9, "where it is looked at, scene units"},
    {"late", 1, 0, 1, "1: moments of density 2 t, 0: of even density", true}};

const CasesOf<Family::film> cases({
    {.name = "film_sum",
     .catalogue = "S43",
     .title = "the sum of up to 1e8 samples of a pixel",
     .stiff = "a sum in single precision stops at 2^24 times the samples' size: 1e8 samples of 0.1 lose four fifths",
     .formula = "the mean of the samples, summed in extended precision",
     .parameters = {{"content", 0, 0, 4,
                     "0: 0.1, 1: 1, 2: U in [0, 1), 3: 0.18 U and one in 1e5 of 1e5, 4: 1e-3 U after one of 1e6", true},
                    {"samples", 1e6, 1, 1e9, "of the pixel", true}},
     .points = table({"content", "samples"}, {{0, 1e4}, {0, 1e6}, {0, 1e8}, {1, 1e8}, {2, 1e7}, {3, 1e7}, {4, 1e7}}),
     .quick_points = along("content", {0, 2, 3}),
     .sweep = "samples",
     .direct = film_sum,
     .direct_has_naive = true,
     .known_limit = coarse_film},
    {.name = "pixel_jitter",
     .catalogue = "S45",
     .title = "samples stay in their pixel",
     .stiff = "x + u rounds to x + 1 far from an image's first pixels: the sample is another pixel's",
     .formula = "the place in the pixel lies in [0, 1), 1/2 on average",
     .parameters = {{"width", 4096, 1, 65536, "of the image, pixels", true},
                    {"x", 65535, 0, 65535, "the pixel's column, or the last one", true}},
     .points = {{{"width", 64}}, {{"width", 4096}}, {{"width", 65536}}, {{"width", 65536}, {"x", 0}}},
     .quick_points = along("width", {4096, 65536}),
     .sweep = "width",
     .direct = pixel_jitter},
    {.name = "lens_closed",
     .catalogue = "S46",
     .title = "an aperture of 0 is a pinhole",
     .stiff = "normalize((o + F d) - o) is d in one ray of a hundred: a lens of no size must not be computed at all",
     .formula = "the same film, bit for bit",
     .parameters = {{"focus", 3, 1e-18, 1e18, "distance of the focus, scene units"}},
     .points = along("focus", {3, 1e6}),
     .twins = closed_lens},
    {.name = "lens_edge",
     .catalogue = "S46",
     .title = "an edge out of focus",
     .stiff =
         "a focus at 1e6 scene units, or an aperture of 1e3: points on the lens and on the focal plane of one size",
     .formula = "1 - [acos x - x sqrt(1 - x^2)] / pi, x in radii of the blur A |z - F| / F",
     .parameters = {{"aperture", 0.1, 1e-6, 1e6, "radius A of the lens, scene units"},
                    {"focus", 2, 1e-3, 1e12, "distance F of the focus, scene units"},
                    {"z", 5, 1e-3, 1e6, "of the edge, scene units; not F"},
                    {"x", -0.5, -1, 1, "the edge's place in blur radii"}},
     .points = joined({along("x", {-0.5, -1.0 / 6, 1.0 / 6, 0.5}), along("focus", {1e6}),
                       along("aperture", {1e3, 1e-4})}),
     .quick_points = {{{"x", -0.5}}, {{"focus", 1e6}}},
     .sweep = "x",
     .renderings = lens_edge},
    {.name = "motion",
     .catalogue = "S47",
     .title = "a box of light that passes while the shutter is open",
     .stiff = "v t of a fast object has steps: 0.06 scene units at 1e6 a second, in single precision",
     .formula = "min(1, x/v)^2 - max(0, (x - w)/v)^2 with moments t = sqrt(u); without the squares with t = u",
     .parameters = motion_parameters,
     .points = {{{"v", 4}, {"x", 2}},
                {{"v", 100}, {"x", 24}},
                {{"v", 100}, {"x", 99}},
                {{"v", 100}, {"x", 24}, {"late", 0}},
                {{"v", 1e6}, {"x", 5e5}, {"width", 1e4}},
                {{"v", 1e6}, {"x", 999999}}},
     .quick_points = {{{"v", 4}, {"x", 2}}, {{"v", 1e6}, {"x", 5e5}, {"width", 1e4}}},
     .sweep = "v",
     .renderings = motion,
     .known_limit = rarely_passed},
    {.name = "motion_grid",
     .catalogue = "S47",
     .title = "the moments at which a passing box is met, all 2^24 of them",
     .stiff = "a box that passes in 1e-6 seconds is met at a handful of the moments that single precision has",
     .formula = "as of motion",
     .parameters = motion_parameters,
     .points = table({"v", "x"}, {{100, 24}, {100, 99}, {1e4, 9999}, {1e6, 1.25e5}, {1e6, 999999}}),
     .quick_points = table({"v", "x"}, {{100, 24}, {1e6, 999999}}),
     .sweep = "v",
     .direct = motion_grid,
     .direct_has_naive = true,
     .direct_has_mixed = true},
    {.name = "motion_zero",
     .catalogue = "S47",
     .title = "no velocity, or no time, is no motion",
     .stiff = "p - 0 t and p + 0 t must leave every bit, and the moment's random number every other one",
     .formula = "the same film, bit for bit",
     .twins = still_shutter},
    {.name = "pixel_edge",
     .catalogue = "S48",
     .title = "an edge through a pixel",
     .stiff = "a filter that is no box, or samples that leave it, show in the mean and in the variance",
     .formula = "mean s, variance s (1 - s) / N, for an edge that leaves the share s",
     .parameters = {{"share", 0.5, 0, 1, "of the pixel that is covered"}},
     .points = along("share", {0.1, 0.5, 0.875, 0.999}),
     .quick_points = along("share", {0.1, 0.875}),
     .sweep = "share",
     .renderings = pixel_edge},
});

}  // namespace
}  // namespace pt::stability::film
