// What kernels that run on host threads are held to: every path of an image by itself, from its camera ray to its end.
#pragma once

#include <utility>
#include <vector>

#include "harness/render/film.h"
#include "variants/integrator/depth_first.h"

namespace pt::test {

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
