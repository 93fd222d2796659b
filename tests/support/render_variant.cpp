#include "harness/render/renderer.h"
#include "tests/support/render.h"

namespace pt::test {

Film render_variant(const Scene& scene, const RenderOptions& options, const std::string& axis,
                    const std::string& choice) {
    RenderRequest request;
    request.variant = Registry::instance().baseline();
    if (!axis.empty()) {
        request.variant.set(axis, choice);
    }
    if (options.final_bounce) {
        request.variant.set("direct_light", "final_bounce");
    }
    request.settings = default_settings(scene);
    request.settings.depth = options.depth != 0 ? options.depth : scene.max_depth;
    request.settings.seed = options.seed;
    request.first_sample = options.first_sample;
    request.samples = options.samples;
    request.film_samples = options.film_samples;
    return pt::render(scene, request).film;
}

}  // namespace pt::test
