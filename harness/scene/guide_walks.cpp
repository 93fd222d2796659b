#include "harness/scene/guide_walks.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pt {

double artanh_of_decay(double albedo) {
    // Newton's method begins beyond the root of tanh(theta) - albedo theta, where that function is concave and
    // negative, so it descends to the root and ends when rounding stops the descent. For an albedo near 1 each step
    // covers only a third of the way until it is close.
    double theta = 1 / albedo;
    for (int step = 0; step < 200; ++step) {
        const double tangent = std::tanh(theta);
        const double slope = (1 - tangent) * (1 + tangent) - albedo;
        const double next = theta - (tangent - albedo * theta) / slope;
        if (!(next < theta && next > 0)) {
            break;
        }
        theta = next;
    }
    return theta;
}

double guide_decay(double albedo, double g, double depth) {
    if (albedo >= 1) {
        return least_decay;
    }
    const double remaining = 1 - albedo * g;  // extinction after the similarity reduction, relative to sigma_t
    const double similar = albedo * (1 - g) / remaining;
    // The decay rate kappa, root of albedo = kappa / artanh(kappa), is 1 in double precision for albedos below 0.04.
    const double root = similar > 0.04 ? similar * artanh_of_decay(similar) : 1;
    const double in_half_space = root * remaining;
    return std::clamp(in_half_space * std::tanh(in_half_space * depth), least_decay, most_decay);
}

double depth_of(const SceneObject& object) {
    const Vec3d& size = object.scale;
    if (object.shape == Shape::box) {
        return 0.5 / (1 / size.x + 1 / size.y + 1 / size.z);
    }
    if (object.shape == Shape::sphere) {
        // Thomsen's formula for the surface of an ellipsoid, right to 1.1 %.
        constexpr double p = 1.6075;
        const double x = std::pow(size.x, p), y = std::pow(size.y, p), z = std::pow(size.z, p);
        return size.x * size.y * size.z / 6 / std::pow((x * y + y * z + z * x) / 3, 1 / p);
    }
    return std::numeric_limits<double>::infinity();
}

template <class Real>
void guide_walks(ScatteringMedium<Real>& medium, const SceneMaterial& body, double guided_share, double depth) {
    medium.guided_share = static_cast<Real>(guided_share);
    for (int i = 0; i < 3; ++i) {
        const double sigma_t = body.sigma_a[i] + body.sigma_s[i];
        const double albedo = sigma_t > 0 ? body.sigma_s[i] / sigma_t : 0;
        const double in_mean_free_paths = sigma_t > 0 ? sigma_t * depth : 0;
        medium.guide_decay[i] = static_cast<Real>(guide_decay(albedo, body.g, in_mean_free_paths));
        // A guided walk's guide_albedo is computed from the rounded guide_decay, so that both give consistent pdfs.
        const auto kept = static_cast<double>(medium.guide_decay[i]);
        medium.guide_albedo[i] = static_cast<Real>(kept / std::atanh(kept));
    }
}

template void guide_walks(ScatteringMedium<float>&, const SceneMaterial&, double, double);
template void guide_walks(ScatteringMedium<double>&, const SceneMaterial&, double, double);

}  // namespace pt
