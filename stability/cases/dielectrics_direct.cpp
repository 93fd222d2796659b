// Cases S26, S28, S29, S31: the kernels' Fresnel reflectance against long double, and drift over total reflections.
#include <algorithm>
#include <cmath>
#include <limits>

#include "stability/cases/host_kernel.h"
#include "stability/oracles/fresnel.h"

namespace pt::stability::dielectrics_direct {
namespace {

constexpr double not_found = std::numeric_limits<double>::infinity();

// The boundary that the scene loader makes of a refractive index, for entering or leaving rays.
template <class Real>
Boundary<Real> boundary_of(double ior, bool leaving) {
    SceneText text("boundary");
    text.sphere(text.dielectric(ior), {0, 0, 5}, 1);
    const HostScene<Config<Real, all_features>> scene(text);
    const Material<Real>& material = scene.view().materials[0];
    return material.dielectric.seen_from(leaving);
}

long double excess_of(double ior, bool leaving) {
    const long double excess = static_cast<long double>(ior) - 1;
    return leaving ? -excess / (1 + excess) : excess;
}

// How much a reflectance changes if index and cosine change by `rounding`; unbounded near the critical angle.
long double spread(long double excess, long double cosine, long double rounding) {
    const long double moved = (std::abs(excess) + excess * excess) * rounding;
    return std::abs(reflectance(excess + moved, cosine) - reflectance(excess - moved, cosine)) +
           std::abs(reflectance(excess, cosine * (1 + rounding)) - reflectance(excess, cosine * (1 - rounding)));
}

template <class Kernel>
double worst_reflectance(double ior, bool leaving, bool is_quick) {
    using Real = typename Kernel::Real;
    const Boundary<Real> boundary = boundary_of<Real>(ior, leaving);
    const long double excess = excess_of(ior, leaving);
    const int steps = is_quick ? 20000 : 1000000;
    double worst = 0;
    for (int i = 0; i <= steps; ++i) {
        // Half of the cosines of incidence are uniform in [0, 1], the others logarithmic from 1e-8 on.
        const double share = static_cast<double>(i) / steps;
        const auto cosine = static_cast<Real>(i % 2 == 0 ? share : std::pow(10.0, -8 * share));
        const long double exact = reflectance(excess, cosine);
        const auto found = static_cast<long double>(fresnel<Kernel>(boundary, cosine).reflectance);
        const long double error = std::abs(found - exact);
        const long double beyond = error - spread(excess, cosine, 2 * unit_round_off<Real>);
        worst = std::isfinite(error) ? std::max(worst, static_cast<double>(beyond)) : not_found;
    }
    return worst;
}

std::vector<Measurement> index_near_one(const Values& v, const DirectSetting& setting) {
    return with_kernel(setting, [&]<class Kernel>() {
        const Tolerance tolerance{1e-6, 2e-15,
                                  "numerics.md S26: 1e-6 in single precision, as many roundings in double"};
        std::vector<Measurement> found;
        for (const bool leaving : {false, true}) {
            found.push_back({.quantity = leaving ? "worst error of R, leaving" : "worst error of R, entering",
                             .measured = worst_reflectance<Kernel>(1 + v["excess"], leaving, setting.is_quick),
                             .tolerance = tolerance});
        }
        return found;
    });
}

// The diffuse average of the reflectance, the integral of 2 R mu dmu, with the R of the kernel.
template <class Kernel>
double diffuse_average(double ior, bool leaving) {
    using Real = typename Kernel::Real;
    const Boundary<Real> boundary = boundary_of<Real>(ior, leaving);
    const long double n = ior;
    // From within the glass, cosines below `critical` are totally reflected; the reflectance has a square root there.
    const long double critical = leaving ? std::sqrt((n - 1) * (n + 1)) / n : 0;
    long double sum = critical * critical;
    for (const Node& node : graded_nodes(critical, 1, 40)) {
        sum += node.weight * 2 * node.x *
               static_cast<long double>(fresnel<Kernel>(boundary, static_cast<Real>(node.x)).reflectance);
    }
    return static_cast<double>(sum);
}

std::vector<Measurement> diffuse_fresnel(const Values& v, const DirectSetting& setting) {
    return with_kernel(setting, [&]<class Kernel>() {
        const long double n = v["ior"];
        const Tolerance tolerance{1e-6, 1e-12, "numerics.md S26: 1e-6 of any reflectance in single precision"};
        return std::vector<Measurement>{{.quantity = "from outside",
                                         .measured = diffuse_average<Kernel>(v["ior"], false),
                                         .exact = static_cast<double>(diffuse_reflectance(n)),
                                         .tolerance = tolerance},
                                        {.quantity = "from within",
                                         .measured = diffuse_average<Kernel>(v["ior"], true),
                                         .exact = static_cast<double>(internal_diffuse_reflectance(n)),
                                         .tolerance = tolerance}};
    });
}

// A ray that is reflected again and again inside the only body of a scene.
template <class Kernel>
class Billiard {
public:
    using Real = typename Kernel::Real;

    Billiard(const SceneText& text, const Vec3d& origin, const Vec3d& direction) : scene_(text) {
        ray_ = {Vec3<Real>(origin), normalize(Vec3<Real>(direction)), Real(0), SurfaceId{}};
    }
    const Ray<Real>& ray() const { return ray_; }
    const SceneView<Real>& view() const { return scene_.view(); }
    // Follows the ray to its next reflection inside the body; returns false if the ray has left the body.
    bool reflect_once() {
        const Hit<Real> hit = closest_hit<Kernel>(view(), ray_);
        if (!hit.side.exists() || !hit.side.inside()) {
            return false;
        }
        const SurfacePoint<Real> point = surface_at<Kernel>(view(), ray_, hit);
        ray_ = {point.position, reflect(ray_.direction, -point.normal), Real(0), hit.side};
        return true;
    }

private:
    HostScene<Kernel> scene_;
    Ray<Real> ray_;
};

std::vector<Measurement> pipe_invariants(const Values& v, const DirectSetting& setting) {
    return with_kernel(setting, [&]<class Kernel>() {
        const Vec3d turn = Vec3d(10, 20, 30) * v["turn"];
        SceneText text("pipe");
        text.box(text.dielectric(1.5), {0, 0, 0}, {1, 1, v["length"]}, turn);
        const Rotation axes = rotation_of(turn);
        const Vec3d local(0.48, 0.6, 0.64);
        Billiard<Kernel> billiard(text, {0, 0, 0},
                                  axes.column[0] * local.x + axes.column[1] * local.y + axes.column[2] * local.z);
        const double bounces = v["bounces"];
        double worst = 0;
        for (double i = 0; i < bounces; ++i) {
            if (!billiard.reflect_once()) {
                worst = not_found;
                break;
            }
            const Vec3d direction(billiard.ray().direction);
            for (int axis = 0; axis < 3; ++axis) {
                worst = std::max(worst, std::abs(std::abs(dot(direction, axes.column[axis])) - local[axis]));
            }
        }
        return std::vector<Measurement>{{.quantity = "worst change of |dx|, |dy|, |dz|",
                                         .measured = worst,
                                         .tolerance = {1e-6 * std::sqrt(bounces), 2e-15 * std::sqrt(bounces),
                                                       "numerics.md S28: 1e-6 sqrt(bounces), as many roundings in "
                                                       "double"}}};
    });
}

std::vector<Measurement> whispering_gallery(const Values& v, const DirectSetting& setting) {
    return with_kernel(setting, [&]<class Kernel>() {
        const double b = v["impact"], radius = v["radius"];
        SceneText text("gallery");
        // The eye, which is the origin for kernels, is at the centre of the sphere that reflects the ray.
        text.sphere(text.dielectric(1.5), {0, 0, 0}, 2 * radius);
        // The ray starts at the middle of a chord of the sphere that lies in no coordinate plane.
        const Frame<double> frame(normalize(Vec3d(1, 2, 3)));
        Billiard<Kernel> billiard(text, frame.to_world({b * radius, 0, 0}), frame.to_world({0, 0.8, 0.6}));
        double worst = 0;
        for (double i = 0; i < v["bounces"]; ++i) {
            if (!billiard.reflect_once()) {
                worst = not_found;
                break;
            }
            const Vec3d momentum = cross(Vec3d(billiard.ray().origin), Vec3d(billiard.ray().direction));
            const double change = std::abs(std::sqrt(dot(momentum, momentum)) / radius - b);
            worst = std::isfinite(change) ? std::max(worst, change) : not_found;
        }
        const double bounces = v["bounces"] + 1;
        return std::vector<Measurement>{{.quantity = "worst change of |p x d|",
                                         .measured = worst,
                                         .tolerance = {1e-7 * bounces, 2e-16 * bounces,
                                                       "numerics.md S29: 1e-7 a bounce, as many roundings in double"}}};
    });
}

const CasesOf<Family::dielectrics> cases({
    {.name = "index_near_one",
     .catalogue = "S26",
     .title = "the reflectance of a boundary of an index of nearly 1",
     .stiff = "1 - cos^2 and 1 - n^2 cancel: at n = 1 and a cosine of 1e-4 the textbook's form is a mirror",
     .formula = "Fresnel's equations in long double from q^2 = c^2 + e (2 + e), n = 1 + e",
     .parameters = {{"excess", 0x1p-20, 0, 10, "index - 1"}},
     .points = along("excess", {0, 0x1p-10, 0x1p-14, 0x1p-17, 0x1p-20, 0x1p-23, 1e-6, 0.5}),
     .quick_points = along("excess", {0, 0x1p-20, 0.5}),
     .sweep = "excess",
     .direct = index_near_one,
     .direct_has_naive = true},
    {.name = "pipe_invariants",
     .catalogue = "S28",
     .title = "directions in a rod after many reflections",
     .stiff = "a reflection's rounding is repeated some million times, and a drifting length grows exponentially",
     .formula = "|dx|, |dy| and |dz| along the rod's axes are kept by every reflection",
     .parameters = {{"bounces", 1e4, 1, 1e6, "reflections", true},
                    {"length", 1000, 1, 1e6, "of the rod, in widths"},
                    {"turn", 0, 0, 1, "of the rod, by so much of 10, 20 and 30 degrees"}},
     .points = joined({along("bounces", {100, 1e4, 1e6}), table({"bounces", "turn"}, {{100, 1}, {1e4, 1}, {1e6, 1}})}),
     .quick_points = {{{"bounces", 1e4}}, {{"bounces", 1e4}, {"turn", 1}}},
     .sweep = "bounces",
     .direct = pipe_invariants,
     .direct_has_naive = true,
     .direct_has_mixed = true},
    {.name = "whispering_gallery",
     .catalogue = "S29",
     .title = "a ray that creeps along a sphere from within",
     .stiff = "every chord repeats the last one's errors, magnified, and the shorter the chord the nearer is the next "
              "hit to the last",
     .formula = "|p x d| is kept by every reflection",
     .parameters = {{"impact", 0.9, 0.01, 0.99999, "|p x d| over the radius"},
                    {"radius", 1, 1e-6, 1e6, "of the sphere, scene units"},
                    {"bounces", 1e4, 1, 1e8, "reflections", true}},
     .points = joined({along("impact", {0.8, 0.9, 0.99, 0.9999}),
                       table({"impact", "radius"}, {{0.9999, 1e-3}, {0.9, 1e6}}),
                       table({"impact", "bounces"}, {{0.9, 100}, {0.9, 1e6}})}),
     .quick_points = {{{"impact", 0.9}}, {{"impact", 0.9999}, {"radius", 1e-3}}},
     .sweep = "impact",
     .direct = whispering_gallery,
     .direct_has_naive = true,
     .direct_has_mixed = true},
    {.name = "diffuse_fresnel",
     .catalogue = "S31",
     .title = "reflectance of a boundary for diffuse light",
     .stiff = "from within, most of it is total reflection, and the critical angle is a root",
     .formula = "F = 2 int R mu dmu in closed form (Walsh; near n = 1 by quadrature), within: 1 - (1 - F) / n^2",
     .parameters = {{"ior", 1.5, 1.000001, 1000, "of the body"}},
     .points = along("ior", {1.000001, 1.001, 1.33, 1.5, 2, 2.4, 10}),
     .quick_points = along("ior", {1.000001, 1.5}),
     .sweep = "ior",
     .direct = diffuse_fresnel,
     .direct_has_naive = true},
});

}  // namespace
}  // namespace pt::stability::dielectrics_direct
