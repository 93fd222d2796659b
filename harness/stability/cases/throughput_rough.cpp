// S38: the lobe of a rough conductor on its way to the mirror, seen straight on, where facets and what they keep follow
// from the random numbers in closed form.
#include <algorithm>
#include <cmath>

#include "harness/stability/case.h"
#include "harness/stability/cases/host_kernel.h"

namespace pt::stability::throughput_rough {
namespace {

// A facet of slope m sends light from straight above to slope 2 m / (1 - m^2), where Smith's masking keeps
// 1 / (1 + Lambda) of it.
struct Exact {
    long double sine;  // of the direction's angle to the normal
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
        constexpr int side = 256;  // points that single precision holds exactly
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

const CaseRegistration cases({
    {.name = "rough_mirror",
     .catalogue = "S38",
     .family = "throughput",
     .title = "the lobe of a rough metal on its way to a mirror",
     .stiff = "sqrt(1 - cos^2) of a narrow lobe has three values left where it is 1e-8 wide",
     .formula = "facets of slope alpha r / sqrt(1 - r^2), r the radius on the disc; 1 / (1 + Lambda) of Smith",
     .parameters = {{"roughness", 0.1, 1e-6, 1, "alpha is its square"}},
     .points = {{{"roughness", 1e-4}},
                {{"roughness", 1e-3}},
                {{"roughness", 1e-2}},
                {{"roughness", 0.1}},
                {{"roughness", 0.5}},
                {{"roughness", 1}}},
     .quick_points = {{{"roughness", 1e-4}}, {{"roughness", 1}}},
     .sweep = "roughness",
     .direct = rough_mirror},
});

}  // namespace
}  // namespace pt::stability::throughput_rough
