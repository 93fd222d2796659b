// Bodies that light walks through, and what is known of them: slabs, and convex bodies lit from all round.
#pragma once

#include <algorithm>
#include <cmath>

#include "kernels/sampling.h"
#include "tests/support/render.h"
#include "tests/support/scenes.h"

namespace pt::test {

// A sphere, an ellipsoid, a box and a turned box, about 1 across.
inline void add_body(SceneBuilder& builder, int shape, std::uint32_t material) {
    if (shape == 0) {
        builder.sphere(material, {0, 0, 0}, 1.5);
    } else if (shape == 1) {
        builder.ellipsoid(material, {0, 0, 0}, {1.5, 1, 1.25}, {10, 20, 30});
    } else {
        builder.box(material, {0, 0, 0}, {1, 1.25, 1.5}, shape == 2 ? Vec3d(0.0) : Vec3d(10, 20, 30));
    }
}

// Four times volume over surface, of those that are no ellipsoid: the mean chord.
inline double four_v_over_s(int shape) {
    return shape == 0 ? 4.0 / 3.0 * 0.75 : 4 * 1.875 / (2 * (1.25 + 1.5 + 1.875));
}

struct SlabMedium {
    double tau, albedo;
    double g = 0;
    std::uint32_t max_scatterings = 1000000;
};

// What comes back and what comes through.
struct Slab {
    Mean reflected, transmitted;
    std::uint64_t unfinished = 0;
};

// Sends light into a wide slab of optical depth tau from above, at cosine `mu` (0: diffuse incidence).
template <class Real>
Slab slab(const SlabMedium& medium, double mu, int count, const RenderOptions& options) {
    SceneBuilder builder;
    builder.camera({0, medium.tau / 2 + 1, 0}, {0, 0, 0}, {1, 0, 0}).depth(2);
    const std::uint32_t material = builder.subsurface(Vec3d(medium.albedo), Vec3d(1 - medium.albedo), medium.g);
    builder.scene.materials[material].max_scatterings = medium.max_scatterings;
    builder.box(material, {0, 0, 0}, {1e5, medium.tau, 1e5});
    Stages<Real> stages(builder.scene, options);
    Random random(options.seed);
    Slab result;
    for (int i = 0; i < count; ++i) {
        Path<Real> path = stages.generate(0, static_cast<std::uint32_t>(i));
        const double cosine = mu > 0 ? mu : std::max(1e-3, std::sqrt(random.uniform()));
        path.direction = {static_cast<Real>(std::sqrt(1 - cosine * cosine)), static_cast<Real>(-cosine), Real(0)};
        const bool finished = stages.shade(path, stages.intersect(path));
        const double weight = finished ? static_cast<double>(path.throughput.y) : 0;
        const bool up = path.direction.y > 0;
        result.reflected.add(up ? weight : 0);
        result.transmitted.add(up ? 0 : weight);
    }
    result.unfinished = stages.unfinished_walks();
    return result;
}

struct BodyMedium {
    double ior, sigma_s, g;
};

// Light from everywhere alike on a convex body: the mean path inside is n^2 4V/S per photon that arrives (those that
// the boundary reflects count 0). To first order in a weak absorption, that is the share lost over sigma_a. numerics.md
// S35.
inline Mean mean_path(int shape, const BodyMedium& medium, int count, const RenderOptions& options = {}) {
    const double sigma_a = 1e-7;
    SceneBuilder builder;
    builder.depth(2);
    add_body(builder, shape, builder.subsurface(Vec3d(medium.sigma_s), Vec3d(sigma_a), medium.g, medium.ior));
    Stages<double> stages(builder.scene, options);
    Random random(9);
    Mean mean;
    for (std::uint32_t sample = 0; mean.count() < static_cast<std::uint64_t>(count); ++sample) {
        // Parallel rays through a disc that covers the body, from every direction.
        const Frame<double> frame(uniform_sphere(random.uniform(), random.uniform()));
        const double u = random.uniform();
        const Vec2<double> disc = concentric_disc(u, random.uniform());
        Path<double> path = stages.generate(0, sample);
        path.origin = frame.to_world({1.2 * disc.x, 1.2 * disc.y, -3});
        path.direction = frame.normal;
        const Hit<double> hit = stages.intersect(path);
        if (hit.side.exists()) {
            stages.shade(path, hit);
            mean.add((1 - path.throughput.y) / sigma_a);
        }
    }
    return mean;
}

}  // namespace pt::test
