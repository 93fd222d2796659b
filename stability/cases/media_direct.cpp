// Cases S32, S35 and S37, by direct calls of kernel functions: the longest sampled free path, the mean transmittance
// over a disc of parallel rays, mean path lengths in bodies, and the phase function.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "stability/cases/host_kernel.h"
#include "stability/oracles/gauss_legendre.h"

namespace pt::stability::media_direct {
namespace {

// A ball's mean transmittance over its disc, 2 [1 - (1 + t) e^-t] / t^2, by its power series where that would cancel.
double disc_mean(double t) {
    if (t > 0.5) {
        const long double x = t;
        return static_cast<double>(2 * (1 - (1 + x) * std::exp(-x)) / (x * x));
    }
    long double sum = 0, power = 1;  // the power series: 2 times the sum over k of (-t)^k / (k! (k + 2))
    for (int k = 0; k < 30; ++k) {
        sum += 2 * power / (k + 2);
        power *= -static_cast<long double>(t) / (k + 1);
    }
    return static_cast<double>(sum);
}

std::vector<Measurement> absorbing_disc(const Values& v, const DirectSetting& setting) {
    return with_kernel(setting, [&]<class Kernel>() {
        using Real = typename Kernel::Real;
        const double t = v["t"];
        SceneText text("disc");
        text.camera({0, 0, 0}, {0, 0, 1}).depth(3).environment(1);
        text.sphere(text.dielectric(1, Vec3d(t / 2)), {0, 0, 5}, 2);
        const HostScene<Kernel> scene(text);
        // The mean transmittance over the ball's disc is 2 int e^(-t s) s ds over half chords s.
        long double mean = 0;
        for (const Node& node : gauss_legendre(64)) {
            Path<Real> path = generate<Kernel>(scene.view(), 0, 0);
            path.origin = {static_cast<Real>(std::sqrt((1 - node.x) * (1 + node.x))), Real(0), Real(0)};
            path.direction = {Real(0), Real(0), Real(1)};
            PathCounters counters;
            while (shade<Kernel>(scene.view(), scene.view(), path, intersect<Kernel>(scene.view(), path), counters)) {
            }
            mean += 2 * node.weight * node.x * static_cast<long double>(path.radiance.x);
        }
        const double roundings = 32 * (1 + 5 * t);
        return std::vector<Measurement>{{.quantity = "mean transmittance of the disc",
                                         .measured = static_cast<double>(mean),
                                         .exact = disc_mean(t),
                                         .tolerance = {roundings * 0x1p-24, roundings * 0x1p-53,
                                                       "32 roundings of the chord, 5 radii away, and of e^-t"}}};
    });
}

// The share of the 2^32 random words that give a free path beyond tau, by bisection: the path falls with the word.
template <class Real>
double share_beyond(double tau) {
    std::uint64_t low = 0, high = std::uint64_t{1} << 32;  // words below `low` give paths beyond tau, from `high` none
    while (low < high) {
        const std::uint64_t word = (low + high) / 2;
        const Real path = -logarithm(positive_unit_interval<Real>(static_cast<std::uint32_t>(word)));
        if (static_cast<double>(path) > tau) {
            low = word + 1;
        } else {
            high = word;
        }
    }
    return static_cast<double>(low) * 0x1p-32;
}

std::vector<Measurement> free_path(const Values& v, const DirectSetting& setting) {
    return with_kernel(setting, [&]<class Kernel>() {
        using Real = typename Kernel::Real;
        const double tau = v["tau"], exact = std::exp(-tau);
        const double roundings = (2 + 2 * tau) * exact;
        const auto longest = static_cast<double>(-logarithm(positive_unit_interval<Real>(0)));
        return std::vector<Measurement>{
            {.quantity = "share of free paths beyond tau",
             .measured = share_beyond<Real>(tau),
             .exact = exact,
             .tolerance = {0x1p-32 + roundings * 0x1p-24, 0x1p-32 + roundings * 0x1p-53,
                           "one word of 2^32, and the rounding of the number and of its logarithm"}},
            {.quantity = "longest free path",
             .measured = longest,
             .exact = 33 * std::numbers::ln2,
             .tolerance = {33 * 0x1p-24, 33 * 0x1p-53, "-ln of half a word of 2^32, finite; its rounding"}}};
    });
}

struct Mean {
    double sum = 0, squares = 0, count = 0;
    void add(double value) {
        sum += value;
        squares += value * value;
        count += 1;
    }
    double value() const { return sum / count; }
    double standard_error() const { return std::sqrt((squares / count - value() * value()) / count); }
};

// The length of a path's random walk inside a body.
template <class Kernel>
double walk_length(const SceneView<typename Kernel::Real>& scene, Path<typename Kernel::Real>& path,
                   WalkOf<Kernel>& walk) {
    PathCounters counters;
    double length = 0;
    while (walk.is_on()) {
        const Vec3d from(path.origin);
        walk_on<Kernel>(scene, path, walk, counters);
        const Vec3d way = Vec3d(path.origin) - from;
        length += std::sqrt(dot(way, way));
    }
    return length;
}

SceneText body_scene(const Values& v, double* four_v_over_s) {
    SceneText text("body");
    text.camera({0, 0, 8}, {0, 0, 0}).depth(2);
    // The cap on scatterings, some hundred times the square of the optical depth, ends only walks that are stuck.
    const double crossing = v["sigma"] * v["ior"] + 10;
    const auto cap = static_cast<std::uint32_t>(std::min(1e9, 400 * crossing * crossing));
    const std::string material = text.subsurface(Vec3d(v["sigma"]), Vec3d(0.0), v["g"], v["ior"], cap);
    if (v.whole("shape") == 0) {
        text.sphere(material, {0, 0, 0}, 2);
        *four_v_over_s = 4.0 / 3.0;
    } else {
        const Vec3d size(1, 1.25, 1.5);
        text.box(material, {0, 0, 0}, size, v.whole("shape") == 1 ? Vec3d(0.0) : Vec3d(10, 20, 30));
        *four_v_over_s = 2 * size.x * size.y * size.z / (size.x * size.y + size.y * size.z + size.z * size.x);
    }
    return text;
}

// The mean path length through a body under Lambertian light: parallel rays from all directions, over a covering disc.
std::vector<Measurement> mean_path(const Values& v, const DirectSetting& setting) {
    return with_kernel(setting, [&]<class Kernel>() {
        using Real = typename Kernel::Real;
        double four_v_over_s = 0;
        const HostScene<Kernel> scene(body_scene(v, &four_v_over_s));
        const Vec3d to_body(0, 0, -8);  // position of the body relative to the eye, which is the kernels' origin
        std::mt19937_64 generator(9);
        const auto uniform = [&] { return static_cast<double>(generator() >> 11) * 0x1p-53; };
        const double work = 1 + v["sigma"] * v["ior"] * v["ior"] * four_v_over_s;
        const auto count = static_cast<std::uint32_t>((setting.is_quick ? 5e5 : 2e7) / (4 + work));
        Mean mean;
        for (std::uint32_t sample = 0; mean.count < count; ++sample) {
            const Frame<double> frame(uniform_sphere(uniform(), uniform()));
            const double u = uniform();
            const Vec2<double> disc = concentric_disc(u, uniform());
            Path<Real> path = generate<Kernel>(scene.view(), 0, sample);
            path.origin = Vec3<Real>(to_body + frame.to_world({1.2 * disc.x, 1.2 * disc.y, -3}));
            path.direction = normalize(Vec3<Real>(frame.normal));
            const Hit<Real> hit = intersect<Kernel>(scene.view(), path);
            if (!hit.side.exists()) {
                continue;
            }
            PathCounters counters;
            WalkOf<Kernel> walk;
            shade<Kernel>(scene.view(), scene.view(), path, hit, counters, walk);
            mean.add(walk_length<Kernel>(scene.view(), path, walk));
        }
        return std::vector<Measurement>{
            {.quantity = "mean path inside",
             .measured = mean.value(),
             .exact = v["ior"] * v["ior"] * four_v_over_s,
             .standard_error = mean.standard_error(),
             .tolerance = {1e-6 + 1e-6 * work, 1e-12 + 1e-12 * work,
                           "positions rounded at the eye's distance of 8, at every collision"}}};
    });
}

// The cumulative probability P(cos < mu) of Henyey and Greenstein's phase function.
long double phase_cdf(long double g, long double mu) {
    if (g == 0) {
        return (1 + mu) / 2;
    }
    // The probability is (1-g^2)/2g [1/sqrt(1+g^2-2 g mu) - 1/(1+g)], here rearranged so that nothing cancels.
    const long double root = std::sqrt((1 - g) * (1 - g) + 2 * g * (1 - mu));
    return (1 - g) * (1 + mu) / (root * (1 + g + root));
}

std::vector<Measurement> phase_function(const Values& v, const DirectSetting& setting) {
    return with_kernel(setting, [&]<class Kernel>() {
        using Real = typename Kernel::Real;
        const auto g = static_cast<Real>(v["g"]);
        const std::uint32_t steps = setting.is_quick ? 1u << 14 : 1u << 20;
        long double mean = 0;
        double worst = 0;
        for (std::uint32_t i = 0; i < steps; ++i) {
            const Real u = (static_cast<Real>(i) + Real(0.5)) / static_cast<Real>(steps);
            const auto cosine = static_cast<long double>(henyey_greenstein_cosine(g, u));
            mean += cosine / steps;
            // The sampled cosine must be the exact inverse of a share near u, within the kernel's roundings: five of
            // numbers up to 1, and that of the divisor 1 + g (1 - 2u). Near the peak one rounding of the cosine spans a
            // tenth of all directions.
            const long double divisor = 1 + static_cast<long double>(g) * (1 - 2 * static_cast<long double>(u));
            const long double rounding = (5 + 1 / divisor) * unit_round_off<Real>;
            const long double wide = static_cast<long double>(g);
            const auto moved = [&](long double by) {
                return 1 - phase_cdf(wide, std::clamp(cosine + by, -1.0L, 1.0L));
            };
            const auto exact = static_cast<long double>(u);
            const long double outside = std::max(moved(rounding) - exact, exact - moved(-rounding));
            worst = std::max(worst, static_cast<double>(outside));
        }
        // Error of the midpoint rule, which gives the mean cosine from cosines sampled at evenly spaced u.
        const double rule = 4.0 / steps / (1 - std::abs(v["g"])) / steps;
        return std::vector<Measurement>{
            {.quantity = "worst error of a cosine beyond its rounding, as a share",
             .measured = worst,
             .tolerance = {16 * 0x1p-24, 16 * 0x1p-53, "16 roundings of numbers up to 1"}},
            {.quantity = "mean cosine",
             .measured = static_cast<double>(mean),
             .exact = static_cast<double>(g),
             .tolerance = {rule + 16 * 0x1p-24, rule + 16 * 0x1p-53, "16 roundings, and the midpoint rule's error"}}};
    });
}

const CasesOf<Family::media> cases({
    {.name = "absorbing_disc",
     .catalogue = "S32",
     .title = "parallel light through an absorbing ball",
     .stiff = "for a clear ball the closed form itself cancels, for an opaque one the limb alone is left",
     .formula = "2 [1 - (1 + t) e^-t] / t^2, t = 2 sigma R, by its series for small t",
     .parameters = {{"t", 1, 0, 50, "absorption along the diameter"}},
     .points = along("t", {1e-4, 1e-3, 0.1, 1, 5, 20}),
     .quick_points = along("t", {1e-3, 5}),
     .sweep = "t",
     .direct = absorbing_disc,
     .direct_has_naive = true,
     .direct_has_mixed = true},
    {.name = "free_path",
     .catalogue = "S32",
     .title = "the free paths that the sampler can draw",
     .stiff = "-ln u of 24 random bits ends at 16.6 mean free paths, and at infinity for u = 0",
     .formula = "e^-tau; the longest is 33 ln 2, of half of the lowest of 2^32 words",
     .parameters = {{"tau", 20, 0.01, 22.8, "mean free paths"}},
     .points = along("tau", {0.1, 1, 10, 16, 18, 20, 22}),
     .quick_points = along("tau", {1, 20}),
     .sweep = "tau",
     .direct = free_path},
    {.name = "mean_path",
     .catalogue = "S35",
     .title = "the mean path in a body under diffuse light",
     .stiff = "few long paths balance many short ones: the mean knows nothing of the scattering, its variance all",
     .formula = "n^2 4V/S for any phase function (Blanco and Fournier 2003); what the boundary reflects counts 0",
     .parameters = {{"shape", 0, 0, 2, "0 sphere, 1 box, 2 turned box", true},
                    {"sigma", 10, 0.1, 1e4, "scattering, 1 / scene unit"},
                    {"g", 0, -0.999, 0.999, "mean cosine of the phase function"},
                    {"ior", 1, 1, 2, "of the body"}},
     .points = {{{"sigma", 0.5}},
                {{"sigma", 10}},
                {{"sigma", 100}},
                {{"sigma", 10}, {"g", 0.9}},
                {{"sigma", 100}, {"g", 0.999}},
                {{"sigma", 10}, {"g", -0.9}},
                {{"sigma", 5}, {"ior", 1.5}},
                {{"sigma", 5}, {"ior", 1.5}, {"g", 0.8}, {"shape", 1}},
                {{"sigma", 5}, {"ior", 1.5}, {"shape", 2}},
                {{"sigma", 1000}}},
     .quick_points = {{{"sigma", 10}}, {{"sigma", 5}, {"ior", 1.5}, {"shape", 2}}},
     .sweep = "sigma",
     .direct = mean_path,
     .direct_has_naive = true,
     .direct_has_mixed = true},
    {.name = "phase_function",
     .catalogue = "S37",
     .title = "cosines of a phase function that is almost a mirror",
     .stiff = "1 + g^2 - 2 g mu cancels near the peak, and the inverse has a division by g",
     .formula = "Henyey and Greenstein's distribution in long double, and its mean cosine g",
     .parameters = {{"g", 0.999, -0.9999, 0.9999, "mean cosine"}},
     .points = along("g", {-0.999, -0.5, 0, 1e-6, 0.5, 0.99, 0.999}),
     .quick_points = along("g", {-0.999, 1e-6, 0.999}),
     .sweep = "g",
     .direct = phase_function},
});

}  // namespace
}  // namespace pt::stability::media_direct
