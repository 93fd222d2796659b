// Many lights, adjacent lights and environments: all ways to sample one of them must give the same sum.
#include <algorithm>
#include <cmath>

#include "harness/scene/environment_table.h"
#include "kernels/texture.h"
#include "stability/cases/receiver.h"
#include "stability/oracles/limits.h"

namespace pt::stability::lights {
namespace {

const std::vector<std::map<std::string, std::string>> every_choice_of_a_light = {
    {{axes::direct_light, "nee"}, {axes::light_selection, "power"}},
    {{axes::direct_light, "nee"}, {axes::light_selection, "light_tree"}},
    {{axes::direct_light, "nee_mis"}, {axes::light_selection, "power"}},
    {{axes::direct_light, "nee_mis"}, {axes::light_selection, "light_tree"}},
    {{axes::direct_light, "nee_one_sample"}, {axes::light_selection, "light_tree"}}};

// The rendering of a receiver lit by many lamps. Every ray is tested against every lamp, so many lamps get up to
// sixteen times fewer paths, with errors up to four times as large.
std::vector<Rendering> lit_by(std::uint32_t lamps, const SceneText& scene, double irradiance,
                              const std::string& origin) {
    const double share = std::clamp(lamps / 256.0, 1.0, 16.0);
    return lit(scene, irradiance, {1e-5, 1e-12, origin}, 1e6 / share, 3e7 / share);
}

// Lamps: balls at distance 1, at heights from 1/2 to 1 and spread by the golden angle so that none hides another:
// centres are more than 1 / sqrt(count) apart, diameters half of that. The brightest has power 1, and powers fall
// uniformly on a logarithmic scale, in an order unrelated to position.
struct ManyBalls {
    std::uint32_t count;
    double decades;

    double radius() const { return 0.25 / std::sqrt(static_cast<double>(count)); }
    Vec3d centre(std::uint32_t i) const {
        const double height = 1 - 0.5 * (i + 0.5) / count, across = std::sqrt((1 - height) * (1 + height));
        const double turn = pi<double> * (3 - std::sqrt(5.0)) * i;
        return {across * std::cos(turn), height, across * std::sin(turn)};
    }
    double radiance(std::uint32_t i) const {
        const double place = static_cast<double>((std::uint64_t{i} * 7919u) % count) / count;
        return std::pow(10.0, -decades * place);
    }
    double irradiance() const {
        double sum = 0;
        for (std::uint32_t i = 0; i < count; ++i) {
            sum += radiance(i) * sphere_irradiance(1 / radius(), std::acos(centre(i).y));
        }
        return sum;
    }
};

ManyBalls balls_of(const Values& v) { return {v.whole("count"), v["decades"]}; }

std::vector<Rendering> many_powers(const Values& v) {
    const ManyBalls balls = balls_of(v);
    SceneText scene = receiver("many_powers", 0.25);
    for (std::uint32_t i = 0; i < balls.count; ++i) {
        scene.sphere(scene.emitter(Vec3d(balls.radiance(i))), balls.centre(i), 2 * balls.radius());
    }
    return lit_by(balls.count, scene, balls.irradiance(),
                  "numerics.md S8: the sum of so many balls, each wholly above the horizon");
}

// A lamp of 2 x 2 at height 1 cut into squares that share edges; together they are a rectangle of case S6.
std::vector<Rendering> touching_lamps(const Values& v) {
    const std::uint32_t side = v.whole("side");
    SceneText scene = receiver("touching_lamps", 0.25);
    const std::string lamp = scene.emitter(Vec3d(1.0));
    const double width = 2.0 / side;
    for (std::uint32_t i = 0; i < side * side; ++i) {
        scene.quad(lamp, {(i % side + 0.5) * width - 1, 1, (i / side + 0.5) * width - 1}, width, width, {180, 0, 0});
    }
    return lit_by(side * side, scene, 4 * rectangle_irradiance(1, 1, 1), "numerics.md S6");
}

// An environment map of uniform grey with one bright texel.
constexpr std::uint32_t sky_width = 64, sky_height = 32, bright_row = 9, bright_column = 21;

SceneEnvironment sky(double contrast) {
    SceneEnvironment environment;
    environment.image.width = sky_width;
    environment.image.height = sky_height;
    environment.image.texels.assign(std::size_t{sky_width} * sky_height, Vec3<float>(1.0f));
    environment.image.texels[bright_row * sky_width + bright_column] = Vec3<float>(static_cast<float>(contrast));
    return environment;
}

// Samples every texel of an environment map once, with the random words in the middle of the texel's share.
std::vector<Measurement> bright_texel(const Values& v, const DirectSetting& setting) {
    const auto measured = [&]<class Real>(Real) {
        const auto contrast = static_cast<double>(static_cast<float>(v["contrast"]));
        const auto table = environment_table<Real>(sky(contrast), 0, true);
        const EnvironmentMap<Real>& map = table->map;
        long double sum = 0;
        std::uint32_t elsewhere = 0;
        for (std::uint32_t row = 0; row < sky_height; ++row) {
            const Real share_of_row = share_of_entry<Real>(map.rows.data, map.rows.size, row);
            const EnvironmentTexel<Real>* const texels = map.texels.data + std::size_t{row} * map.width;
            for (std::uint32_t column = 0; column < sky_width; ++column) {
                const Real share = share_of_entry<Real>(texels, map.width, column);
                const auto middle = [](std::uint32_t first, Real share_of) {
                    return first + static_cast<std::uint32_t>(share_of * Real(0.5));
                };
                const EnvironmentSample<Real> sample = sample_environment(
                    map, middle(map.rows[row].first, share_of_row), middle(texels[column].first, share), 0x80008000u);
                sum += static_cast<long double>(share_of_row) * static_cast<long double>(share) * 0x1p-64L *
                       static_cast<long double>(sample.place.radiance.x) *
                       static_cast<long double>(sample.place.inverse_pdf);
                const EnvironmentPlace<Real> met = environment_towards(map, sample.direction);
                elsewhere +=
                    met.inverse_pdf == sample.place.inverse_pdf && met.radiance == sample.place.radiance ? 0u : 1u;
            }
        }
        const long double row = std::cos(pi<long double> * bright_row / sky_height) -
                                std::cos(pi<long double> * (bright_row + 1) / sky_height);
        const long double exact =
            4 * pi<long double> + 2 * pi<long double> * row / sky_width * (static_cast<long double>(contrast) - 1);
        return std::vector<Measurement>{
            {.quantity = "light from all round over its exact value",
             .measured = static_cast<double>(sum / exact),
             .exact = 1,
             .tolerance = {1e-6, 1e-14, "roundings of a texel's radiance, solid angle and shares"}},
            {.quantity = "texels that are not met where they are drawn",
             .measured = static_cast<double>(elsewhere),
             .tolerance = {0, 0, "a direction to the middle of a texel is in it"}}};
    };
    return setting.precision.is_double() ? measured(double{}) : measured(float{});
}

// A row of texels 0, 1, 0, 1 ..., looked up around texel centres and edges; a lookup is linear between centres.
std::vector<Measurement> texture_edge(const Values& v, const DirectSetting& setting) {
    struct Row {
        std::vector<Vec3<float>> texels;
    };
    const auto measured = [&]<class Real>(Real) {
        const std::uint32_t count = v.whole("texels");
        Row row;
        for (std::uint32_t i = 0; i < count; ++i) {
            row.texels.emplace_back(static_cast<float>(i % 2));
        }
        double worst = 0, least = 1, most = 0;
        for (std::uint32_t i = 0; i < 4096; ++i) {
            // `halves`: place of a lookup in half texels from the image's left edge, up to one texel beyond the right
            // edge. Half of the lookups lie exactly on an edge or centre of a texel.
            const std::uint32_t halves = (i * 2654435761u >> 8) % (2 * count + 4);
            const double beside = i % 2 == 0 ? 0 : static_cast<double>(i) / 4096;
            const auto at = static_cast<Real>((halves + beside) / (2.0 * count));
            // The exact mix of two texels is computed at the place of the lookup as rounded for the kernel.
            const long double place = static_cast<long double>(at) * count - 0.5L;
            const long double below = std::floor(place), share = place - below;
            const auto parity = static_cast<std::int64_t>(below) & 1;
            const auto exact = static_cast<double>(parity == 0 ? share : 1 - share);
            const auto found = static_cast<double>(
                image_at<Real>(row, TexelBlock{count, 1, 0}, Vec2<Real>{at, static_cast<Real>(0.5)}).x);
            worst = std::max(worst, std::abs(found - exact));
            least = std::min(least, found);
            most = std::max(most, found);
        }
        return std::vector<Measurement>{
            {.quantity = "worst difference from the exact blend",
             .measured = worst,
             .tolerance = {0x1p-23 * count, 0x1p-52 * count,
                           "a coordinate of up to 1 is held to 2^-24, and texels are so many times as near"}},
            {.quantity = "least value",
             .measured = least,
             .relation = Relation::at_least,
             .tolerance = {0, 0, "a blend of numbers from 0 to 1"}},
            {.quantity = "greatest value",
             .measured = most,
             .exact = 1,
             .relation = Relation::at_most,
             .tolerance = {0, 0, "a blend of numbers from 0 to 1"}}};
    };
    return setting.precision.is_double() ? measured(double{}) : measured(float{});
}

std::string limit_of_many(const Values& v, const VariantTraits& variant) {
    const ManyBalls balls = balls_of(v);
    // The lamps within one octave of the brightest one's power, which are few, give half of the light.
    const double share =
        balls.radius() * balls.radius() * std::max(1.0, balls.count * 0.3 / std::max(0.3, v["decades"]));
    return rare_or_dim(variant, share, 1, receiver_albedo * balls.irradiance() / pi<double>);
}

const CasesOf<Family::lights> cases({
    {.name = "many_powers",
     .catalogue = "P10",
     .title = "thousands of balls of light whose powers go over twelve decades",
     .stiff =
         "probabilities from 1 to 1e-16 by which light is divided: one that is rounded to 0 is a lamp that is gone",
     .formula = "the sum of pi L (R/d)^2 cos w",
     .parameters = {{"count", 256, 1, 1e5, "lamps", true}, {"decades", 12, 0, 30, "of their powers"}},
     .points = {{{"decades", 0}}, {{"decades", 12}}, {{"count", 4096}}, {{"count", 4096}, {"decades", 0}}},
     .quick_points = along("decades", {12, 0}),
     .sweep = "decades",
     .estimators = {{axes::direct_light, {"nee", "nee_mis"}}},
     .joint_estimators = every_choice_of_a_light,
     .renderings = many_powers,
     .known_limit = limit_of_many},
    {.name = "touching_lamps",
     .catalogue = "P11",
     .title = "one lamp cut into squares that touch",
     .stiff = "a direction towards a lamp's edge that is met in its neighbour is counted twice or never",
     .formula = "four rectangles of S6",
     .parameters = {{"side", 8, 1, 64, "lamps along a side", true}},
     .points = along("side", {1, 8, 32}),
     .quick_points = {{{"side", 8}}},
     .sweep = "side",
     .estimators = {{axes::direct_light, {"nee", "nee_mis"}}},
     .joint_estimators = every_choice_of_a_light,
     .renderings = touching_lamps},
    {.name = "bright_texel",
     .catalogue = "P12",
     .title = "a sky whose light is in one texel",
     .stiff = "a texel 1e8 times as bright as the rest of the sky leaves the others probabilities of 2^-32",
     .formula = "the sum of radiance times solid angle",
     .parameters = {{"contrast", 1e8, 1, 1e30, "of the bright texel to the others"}},
     .points = along("contrast", {1, 1e4, 1e8, 1e16, 1e30}),
     .quick_points = {{{"contrast", 1e8}}},
     .sweep = "contrast",
     .direct = bright_texel},
    {.name = "texture_edge",
     .catalogue = "P13",
     .title = "the blend of an image's texels at their middles and edges",
     .stiff = "at a middle the next pair of texels begins: a coordinate that is rounded up there must not skip one",
     .formula = "linear between the middles of texels, repeated",
     .parameters = {{"texels", 64, 2, 8192, "in a row; an even number", true}},
     .points = along("texels", {2, 64, 1000, 8192}),
     .quick_points = {{{"texels", 64}}},
     .sweep = "texels",
     .direct = texture_edge},
});

}  // namespace
}  // namespace pt::stability::lights
