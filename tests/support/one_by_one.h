// What kernels that run on host threads are held to: every path of an image by itself, from its camera ray to its end.
#pragma once

#include <utility>
#include <vector>

#include "harness/render/film.h"
#include "harness/scene/scene_buffers.h"
#include "variants/integrator/depth_first.h"
#include "variants/registry.h"

namespace pt::test {

// A scene's own settings, but for an image so small that threads of the host render it quickly.
inline RenderSettings few_pixels(const ::pt::Scene& scene, std::uint32_t width, std::uint32_t height) {
    RenderSettings settings = default_settings(scene);
    settings.seed = 1;
    settings.width = width;
    settings.height = height;
    return settings;
}

inline Acceleration by_cwbvh() {
    Variant variant = Registry::instance().baseline();
    variant.set("accelerator", "cwbvh");
    return Acceleration::of(variant, Backend::cpu);
}

struct OneByOne {
    Film film;
    PathCounters counted;
    std::vector<std::uint64_t> lengths;  // paths by their number of segments: 1 and more
};

template <class Config>
OneByOne one_by_one(const SceneView<typename Config::Real>& view, Film film, std::uint32_t first_sample,
                    std::uint32_t samples) {
    OneByOne rendered{std::move(film), {}, std::vector<std::uint64_t>(view.longest_path())};
    for (std::uint32_t pixel = 0; pixel < view.pixel_count(); ++pixel) {
        PixelSum<Config> sum;
        for (std::uint32_t sample = 0; sample < samples; ++sample) {
            const std::uint32_t length = integrator::depth_first::trace<Config>(
                view, rendered.film.view(), sum, pixel, first_sample + sample, nullptr, false, rendered.counted);
            rendered.lengths[length - 1] += 1;
        }
        sum.finish(rendered.film.view(), pixel);
    }
    return rendered;
}

}  // namespace pt::test
