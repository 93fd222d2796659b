#include "tests/support/render.h"

#include "variants/integrator/depth_first.h"

namespace pt::test {

namespace {

template <class Real>
using Generic = Config<Real, all_features | samplings | traversals>;

RenderSettings settings_of(const Scene& scene, const RenderOptions& options) {
    RenderSettings settings = default_settings(scene);
    settings.depth = options.depth != 0 ? options.depth : scene.max_depth;
    settings.seed = options.seed;
    settings.final_bounce = options.final_bounce;
    settings.next_event = options.next_event;
    settings.mis_exponent = options.mis_exponent;
    settings.light_sampling = options.light_sampling;
    settings.near_light = options.near_light;
    settings.light_selection = options.light_selection;
    settings.one_sample = options.one_sample;
    settings.roulette_start = options.roulette_start;
    settings.guided_share = options.guided_share;
    settings.sampler = options.sampler;
    return settings;
}

}  // namespace

template <class Real>
Film render(const Scene& scene, const RenderOptions& options) {
    const RenderSettings settings = settings_of(scene, options);
    const SceneBuffers<Real> buffers(scene, settings);
    const std::uint32_t film_samples = options.film_samples != 0 ? options.film_samples : options.samples;
    Film film(settings.width, settings.height, radiance_bound(scene, settings), film_samples);
    PathCounters counters;
    for (std::uint32_t pixel = 0; pixel < settings.width * settings.height; ++pixel) {
        PixelSum<Generic<Real>> sum;
        for (std::uint32_t i = 0; i < options.samples; ++i) {
            integrator::depth_first::trace<Generic<Real>>(buffers.view(), film.view(), sum, pixel,
                                                          options.first_sample + i, nullptr, false, counters);
        }
        sum.finish(film.view(), pixel);
    }
    return film;
}

template <class Real>
Stages<Real>::Stages(const Scene& scene, const RenderOptions& options)
    : buffers_(std::make_unique<SceneBuffers<Real>>(scene, settings_of(scene, options))) {}

template <class Real>
Path<Real> Stages<Real>::generate(std::uint32_t pixel, std::uint32_t sample) const {
    return pt::generate<Generic<Real>>(view(), pixel, sample);
}

template <class Real>
Hit<Real> Stages<Real>::intersect(const Path<Real>& path) const {
    return pt::intersect<Generic<Real>>(view(), path);
}

template <class Real>
Hit<Real> Stages<Real>::intersect(const Ray<Real>& ray) const {
    return closest_hit<Generic<Real>>(view(), ray);
}

template <class Real>
SurfacePoint<Real> Stages<Real>::surface(const Ray<Real>& ray, const Hit<Real>& hit) const {
    return surface_at<Generic<Real>>(view(), ray, hit);
}

template <class Real>
bool Stages<Real>::shade(Path<Real>& path, const Hit<Real>& hit) {
    PathCounters counters;
    const bool goes_on = pt::shade<Generic<Real>>(view(), view(), path, hit, counters);
    unfinished_walks_ += counters.unfinished_walks;
    return goes_on;
}

template <class Real>
void Stages<Real>::finish(Path<Real>& path) {
    while (shade(path, intersect(path))) {
    }
}

template <class Real>
Vec3d Stages<Real>::radiance(std::uint32_t pixel, std::uint32_t sample) {
    Path<Real> path = generate(pixel, sample);
    finish(path);
    return Vec3d(path.radiance);
}

template <class Real>
ColourMean mean_radiance(const Scene& scene, const RenderOptions& options) {
    Stages<Real> stages(scene, options);
    ColourMean mean;
    for (std::uint32_t pixel = 0; pixel < stages.view().pixel_count(); ++pixel) {
        for (std::uint32_t i = 0; i < options.samples; ++i) {
            mean.add(stages.radiance(pixel, options.first_sample + i));
        }
    }
    return mean;
}

template Film render<float>(const Scene&, const RenderOptions&);
template Film render<double>(const Scene&, const RenderOptions&);
template class Stages<float>;
template class Stages<double>;
template ColourMean mean_radiance<float>(const Scene&, const RenderOptions&);
template ColourMean mean_radiance<double>(const Scene&, const RenderOptions&);

}  // namespace pt::test
