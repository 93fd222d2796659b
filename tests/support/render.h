// Renders scenes for tests with the kernel that has every feature, in float or double, on one thread; and through
// pt::render for the variants of the program.
#pragma once

#include <memory>
#include <string>

#include "harness/render/film.h"
#include "harness/scene/scene_buffers.h"
#include "kernels/intersect.h"
#include "tests/support/statistics.h"

namespace pt::test {

struct RenderOptions {
    std::uint32_t samples = 1;  // a pixel
    std::uint32_t first_sample = 0;
    std::uint32_t film_samples = 0;  // samples that the film is scaled for; 0: `samples`
    std::uint32_t depth = 0;         // 0: the scene's
    std::uint64_t seed = 1;
    bool final_bounce = false;
    bool next_event = false;
    std::uint32_t mis_exponent = 0;
    LightSampling light_sampling = LightSampling::solid_angle;
    std::uint16_t near_light = 0;
    LightSelection light_selection = LightSelection::uniform;
    bool one_sample = false;
    std::uint32_t roulette_start = 0;
    double guided_share = 0;
    FeatureSet sampler = no_features;
};

// Renders a scene path by path, with integrator::depth_first::trace.
template <class Real>
Film render(const Scene& scene, const RenderOptions& options);

// Renders a scene with pt::render: the baseline variant, on all cores, with the given choice on one axis ("" for none).
Film render_variant(const Scene& scene, const RenderOptions& options, const std::string& axis = "",
                    const std::string& choice = "");

// Runs the stages of a path one at a time, of the kernel Config<Real, all_features | samplings | traversals>.
template <class Real>
class Stages {
public:
    explicit Stages(const Scene& scene, const RenderOptions& options = {});

    const SceneView<Real>& view() const { return buffers_->view(); }
    Path<Real> generate(std::uint32_t pixel, std::uint32_t sample) const;
    Hit<Real> intersect(const Path<Real>& path) const;
    Hit<Real> intersect(const Ray<Real>& ray) const;
    SurfacePoint<Real> surface(const Ray<Real>& ray, const Hit<Real>& hit) const;
    bool shade(Path<Real>& path, const Hit<Real>& hit);
    // Traces the path from its present state to its end.
    void finish(Path<Real>& path);
    // Traces a whole path, and returns its radiance.
    Vec3d radiance(std::uint32_t pixel, std::uint32_t sample);

    std::uint64_t unfinished_walks() const { return unfinished_walks_; }
    // The index in scene.objects of the object that has this side.
    std::uint32_t file_index(SurfaceId side) const { return buffers_->file_index()[side.object()]; }

private:
    std::unique_ptr<SceneBuffers<Real>> buffers_;
    std::uint64_t unfinished_walks_ = 0;
};

// Mean radiance a channel with its standard error, all pixels and samples taken as draws of one number.
struct ColourMean {
    Mean channel[3];
    void add(const Vec3d& colour) {
        for (int i = 0; i < 3; ++i) {
            channel[i].add(colour[i]);
        }
    }
};
template <class Real>
ColourMean mean_radiance(const Scene& scene, const RenderOptions& options);

}  // namespace pt::test
