#include "harness/render/first_hits.h"

#include "harness/scene/material_kind.h"
#include "harness/scene/scene_buffers.h"
#include "kernels/shade.h"
#include "variants/cpu/parallel_for.h"

namespace pt {

namespace {

// The kernel configuration for first hits: all features of scenes; sampler and accelerator are chosen at run time.
template <class Real>
using FirstHitConfig = Config<Real, all_features | samplers | traversals, RunTimeAccelerator>;

// Averages the first hits of a pixel in double, so that equal values have exactly that mean.
class FirstHitMean {
public:
    void add(const Vec3d& albedo, const Vec3d& normal, double depth, double coverage) {
        count_ += 1;
        const double share = 1 / count_;
        albedo_ += (albedo - albedo_) * share;
        normal_ += (normal - normal_) * share;
        depth_ += (depth - depth_) * share;
        coverage_ += (coverage - coverage_) * share;
    }
    void store(FirstHits& hits, std::size_t pixel) const {
        for (int i = 0; i < 3; ++i) {
            hits.albedo[3 * pixel + static_cast<std::size_t>(i)] = static_cast<float>(albedo_[i]);
            hits.normal[3 * pixel + static_cast<std::size_t>(i)] = static_cast<float>(normal_[i]);
        }
        hits.depth[pixel] = static_cast<float>(depth_);
        hits.coverage[pixel] = static_cast<float>(coverage_);
    }

private:
    double count_ = 0;
    Vec3d albedo_{0.0}, normal_{0.0};
    double depth_ = 0, coverage_ = 0;
};

template <class Real>
void fill_first_hits(FirstHits& hits, const Scene& scene, const RenderRequest& request,
                     const RenderSettings& settings) {
    using Config = FirstHitConfig<Real>;
    const SceneBuffers<Real> buffers(scene, settings, quick_acceleration(scene));
    const SceneView<Real>& view = buffers.view();
    std::vector<const SceneMaterial*> materials;  // materials of the scene's objects, by object number
    std::vector<Vec3d> albedo;                    // albedos of the scene's objects, by object number
    for (const std::uint32_t index : buffers.file_index()) {
        materials.push_back(&scene.materials[scene.objects[index].material]);
        albedo.push_back(first_hit_albedo(*materials.back()));
    }
    const std::uint32_t kept = Registry::instance()
                                   .at(axes::first_bounce, request.variant, request.backend)
                                   .hook.first_bounce(request.variant, request.backend);
    parallel_for(view.pixel_count(), 64, [&](std::size_t begin, std::size_t end) {
        for (std::size_t pixel = begin; pixel < end; ++pixel) {
            FirstHitMean mean;
            for (std::uint32_t i = 0; i < hits.rays; ++i) {
                const std::uint32_t sample = request.first_sample + i;
                const Path<Real> path = generate<Config>(view, static_cast<std::uint32_t>(pixel), sample,
                                                         kept > 0 ? sample % kept : sample);
                const Ray<Real> ray = ray_of(path);
                const Hit<Real> hit = closest_hit<Config>(view, ray);
                if (!hit.side.exists()) {
                    mean.add(Vec3d(0.0), Vec3d(0.0), 0, 0);
                    continue;
                }
                const SurfacePoint<Real> point = surface_at<Config>(view, ray, hit);
                const Vec3d outward(shading_normal_at<Config>(view, ray, hit, point.position, point.normal));
                Vec3d colour = albedo[hit.side.object()];
                const SceneMaterial& material = *materials[hit.side.object()];
                if (material.texture != nullptr) {
                    Vec3<Real> shown(Real(0));
                    put_texture<Config>(shown, view, ray, hit, point.position, point.normal);
                    colour = first_hit_albedo(material, Vec3d(shown));
                }
                mean.add(colour, hit.side.inside() ? -outward : outward, hit.t, 1);
            }
            mean.store(hits, pixel);
        }
    });
}

}  // namespace

Vec3d first_hit_albedo(const SceneMaterial& material) {
    return first_hit_albedo(material, kind_of(material).surface_colour(material));
}

Vec3d first_hit_albedo(const SceneMaterial& material, const Vec3d& colour) {
    return kind_of(material).first_hit_albedo(material, colour);
}

FirstHits first_hits(const Scene& scene, const RenderRequest& request) {
    const RenderSettings settings = settings_for(request, choose_kernel(scene, request.variant, request.backend));
    const std::size_t pixels = std::size_t{settings.width} * settings.height;
    FirstHits hits;
    hits.rays = std::min(request.samples, most_first_hit_rays);
    hits.albedo.resize(3 * pixels);
    hits.normal.resize(3 * pixels);
    hits.depth.resize(pixels);
    hits.coverage.resize(pixels);
    if (traits_of(request.variant, request.backend).precision.is_double()) {
        fill_first_hits<double>(hits, scene, request, settings);
    } else {
        fill_first_hits<float>(hits, scene, request, settings);
    }
    return hits;
}

}  // namespace pt
