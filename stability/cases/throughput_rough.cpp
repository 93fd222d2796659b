// Case S38: rough metals. Narrow lobes seen along the normal, whose microfacets and weights have closed forms; the
// albedo of a white metal under uniform light; and reciprocity.
#include <algorithm>
#include <cmath>

#include "harness/stability/case.h"
#include "stability/cases/host_kernel.h"
#include "stability/oracles/furnace.h"
#include "stability/oracles/ggx_albedo.h"

namespace pt::stability::throughput_rough {
namespace {

// Light from straight above is reflected by a microfacet of slope m to the slope 2 m / (1 - m^2), where Smith's masking
// keeps 1 / (1 + Lambda) of it.
struct Exact {
    long double sine;  // sine of the angle between reflected direction and surface normal
    long double kept;
};

Exact exact_at(long double alpha, double u, double v) {
    const long double radius = std::max(std::abs(2 * u - 1), std::abs(2 * v - 1));
    const long double slope = alpha * radius / sqrtl((1 - radius) * (1 + radius));
    const long double tangent = 2 * slope / (1 - slope * slope);
    return {2 * slope / (1 + slope * slope), slope < 1 ? 2 / (1 + sqrtl(1 + alpha * alpha * tangent * tangent)) : 0};
}

std::vector<Measurement> rough_mirror(const Values& v, const DirectSetting& setting) {
    return with_kernel(setting, [&]<class Kernel>() {
        using Real = typename Kernel::Real;
        const auto alpha = static_cast<Real>(v["roughness"] * v["roughness"]);
        const Vec3<Real> up{Real(0), Real(0), Real(1)};
        const RoughConductor<Real> lobe(Vec3<Real>(Real(1)), alpha, up, up);
        constexpr int side = 256;  // sample points along each side of a grid; floats represent them exactly
        double worst = 0, kept = 0, kept_exactly = 0;
        for (int i = 0; i < side * side; ++i) {
            const double x = (i % side + 0.5) / side, y = (i / side + 0.5) / side;
            const LobeSample<Real> sample = lobe.sample(static_cast<Real>(x), static_cast<Real>(y));
            const Exact exact = exact_at(static_cast<long double>(alpha), x, y);
            const auto sine = static_cast<long double>(std::hypot(sample.direction.x, sample.direction.y));
            worst = std::max(worst, static_cast<double>(std::abs(sine / exact.sine - 1)));
            kept += sample.cosine > Real(0) ? static_cast<double>(sample.value.weight.x) : 0;
            kept_exactly += static_cast<double>(exact.kept);
        }
        const double count = side * side;
        return std::vector<Measurement>{
            {.quantity = "worst relative error of the sine to the mirror's direction",
             .measured = worst,
             .tolerance =
                 {2e-5, 4e-14,
                  "numerics.md S38: 1 - r^2 of the disc's rim, 2^-7, is held to some 2^-17 in single precision"}},
            {.quantity = "share of an even light that is kept",
             .measured = kept / count,
             .exact = kept_exactly / count,
             .tolerance = {1e-7, 1e-13, "numerics.md S38: roundings of one weight and of the sum"}}};
    });
}

constexpr double fit = 2.5e-3;  // fit error of the multiple scattering gain (kernels/ggx_gain.h)

enum Metal { single_scattering = 0, multiple_scattering = 1, principled = 2 };

// A white metal seen at `degrees` off its normal under uniform light.
std::vector<Rendering> rough_furnace(const Values& v) {
    const double roughness = v["roughness"], angle = v["degrees"] * pi<double> / 180;
    const std::uint32_t kind = v.whole("kind");
    SceneText scene("rough_furnace");
    scene.camera({std::sin(angle), std::cos(angle), 0}, {0, 0, 0}, {0, 0, 1}).depth(2).drawn_environment(1);
    scene.quad(kind == principled ? scene.principled_metal(Vec3d(1.0), roughness)
                                  : scene.rough_conductor(Vec3d(1.0), roughness, kind == multiple_scattering),
               {0, 0, 0}, 8, 8);
    const double once = roughness > 0 ? GgxAlbedo(roughness * roughness, std::cos(angle)).value() : 1;
    const double allowed = kind == multiple_scattering ? fit : 1e-5;
    return {{.scene = scene.json(),
             .quick_paths = paths_for(1e6, 2),
             .full_paths = paths_for(6e7, 2),
             .quantities = {mean_is(
                 "radiance of a white metal in an even light of 1", kind == multiple_scattering ? 1 : once,
                 {allowed, allowed,
                  kind == multiple_scattering ? "kernels/ggx_gain.h: the fit of what single scattering loses"
                                              : "roundings of the eye's direction, on which the share hangs"})}}};
}

// The reciprocity of rough lobes, f(o, i) = f(i, o), as evaluated for next-event estimation.
std::vector<Measurement> rough_reciprocity(const Values& v, const DirectSetting& setting) {
    return with_kernel(setting, [&]<class Kernel>() {
        using Real = typename Kernel::Real;
        const auto alpha = static_cast<Real>(v["roughness"] * v["roughness"]);
        const Vec3<Real> up{Real(0), Real(0), Real(1)};
        const auto direction = [](double cosine, double turn) {
            const double sine = std::sqrt((1 - cosine) * (1 + cosine));
            return renormalize(Vec3<Real>(Vec3<double>(sine * std::cos(turn), sine * std::sin(turn), cosine)));
        };
        const auto bsdf = [&](const Vec3<Real>& outgoing, const Vec3<Real>& incoming) {
            const RoughConductor<Real> lobe(Vec3<Real>(Real(0.5)), alpha, outgoing, up);
            const LobeValue<Real> value = lobe.towards(incoming, incoming.z);
            return static_cast<double>(value.weight.x) * static_cast<double>(value.pdf) /
                   static_cast<double>(incoming.z);
        };
        double worst = 0;
        for (int i = 1; i <= 16; ++i) {
            for (int j = 1; j <= 16; ++j) {
                for (int turn = 0; turn < 8; ++turn) {
                    const Vec3<Real> one = direction(i / 16.5, 0.3), other = direction(j / 16.5, 0.3 + 0.8 * turn);
                    worst = std::max(worst, std::abs(bsdf(one, other) / bsdf(other, one) - 1));
                }
            }
        }
        return std::vector<Measurement>{
            {.quantity = "worst relative difference of a direction's two ways",
             .measured = worst,
             .tolerance = {1e-5, 1e-14,
                           "roundings: 1 + slope^2 of the facet, which both ways share, and two maskings"}}};
    });
}

const CasesOf<Family::throughput> cases({
    {.name = "rough_mirror",
     .catalogue = "S38",
     .title = "the lobe of a rough metal on its way to a mirror",
     .stiff = "sqrt(1 - cos^2) of a narrow lobe has three values left where it is 1e-8 wide",
     .formula = "facets of slope alpha r / sqrt(1 - r^2), r the radius on the disc; 1 / (1 + Lambda) of Smith",
     .parameters = {{"roughness", 0.1, 1e-6, 1, "alpha is its square"}},
     .points = along("roughness", {1e-4, 1e-3, 1e-2, 0.1, 0.5, 1}),
     .quick_points = along("roughness", {1e-4, 1}),
     .sweep = "roughness",
     .direct = rough_mirror},
    {.name = "rough_furnace",
     .catalogue = "S38",
     .title = "a white rough metal in an even light",
     .stiff = "from a mirror to facets of all directions, seen along the surface: densities from 1e8 to 0",
     .formula = "the directional albedo of GGX under Smith's masking, by quadrature; 1 with multiple scattering",
     .parameters = {{"roughness", 0.5, 0, 1, "alpha is its square"},
                    {"degrees", 60, 0, 89.9, "of the eye off the normal"},
                    {"kind", 0, 0, 2, "0: each ray meets one facet, 1: multiple scattering, 2: principled", true}},
     .points = {{{"roughness", 0}},
                {{"roughness", 1e-4}},
                {{"roughness", 1e-2}},
                {{"roughness", 0.09}},
                {{"roughness", 0.5}},
                {{"roughness", 1}},
                {{"roughness", 1}, {"degrees", 0}},
                {{"degrees", 85}},
                {{"roughness", 1}, {"degrees", 89}},
                {{"roughness", 1e-2}, {"kind", 1}},
                {{"kind", 1}},
                {{"roughness", 1}, {"kind", 1}},
                {{"roughness", 1}, {"degrees", 85}, {"kind", 1}},
                {{"roughness", 0.5}, {"kind", 2}},
                {{"roughness", 1}, {"kind", 2}}},
     .quick_points = {{{"roughness", 1e-4}}, {{"roughness", 1}}, {{"kind", 1}}, {{"kind", 2}}},
     .sweep = "roughness",
     .estimators = {{axes::direct_light, {"nee", "nee_mis"}}},
     .renderings = rough_furnace},
    {.name = "rough_reciprocity",
     .catalogue = "S38",
     .title = "a rough metal's two ways of a path",
     .stiff = "the density of a facet far out in a narrow lobe, from directions that are rounded",
     .formula = "f(o, i) = f(i, o)",
     .parameters = {{"roughness", 0.5, 0.0885, 1, "alpha is its square; narrower lobes are not connected"}},
     .points = along("roughness", {0.0885, 0.2, 0.5, 1}),
     .quick_points = along("roughness", {0.0885, 1}),
     .sweep = "roughness",
     .direct = rough_reciprocity},
});

}  // namespace
}  // namespace pt::stability::throughput_rough
