// Scene files: parsed, turned into the arrays that kernels read, and, where that is quick, rendered at 2x2 pixels:
// every sample of an accepted scene is a finite number, 0 or more.
#include <algorithm>

#include "harness/json_reader.h"
#include "harness/mesh/generate.h"
#include "harness/render/film.h"
#include "harness/scene/scene_buffers.h"
#include "tests/fuzz/findings.h"
#include "variants/integrator/depth_first.h"

namespace pt::fuzz {
namespace {

// An input must take milliseconds: longer walks and larger scenes are what tests/image/extreme_scenes_test.cpp is for.
constexpr std::uint32_t most_scatterings = 64;
constexpr std::size_t most_objects = 64;
constexpr std::uint32_t most_depth = 4;
constexpr std::uint64_t most_triangles_made = 256;

// Whether a colour or the roughness of a material is an image: a file, which may be any on this machine.
bool shows_image(const Json& material) {
    return material.is_object() &&
           std::any_of(material.begin(), material.end(), [](const Json& value) { return value.is_object(); });
}

// Whether the text asks for a mesh that takes long to make, or for a file.
bool needs_much(const Json& object) {
    if (!object.is_object() || object.contains("file")) {
        return object.is_object();
    }
    const Json recipe = object.value("generate", Json());
    if (!recipe.is_object() || !recipe.value("mesh", Json()).is_string() || !recipe.value("size", Json()).is_number()) {
        return false;
    }
    const Generator* generator = find_generator(recipe["mesh"].get<std::string>());
    const auto size = recipe["size"].get<double>();
    return generator != nullptr && size >= generator->least_size && size <= generator->most_size &&
           generator->triangles(static_cast<std::uint32_t>(size)) > most_triangles_made;
}

bool needs_much(const std::string& text) {
    const Json scene = parse_json(text, "scene.json");
    if (scene.is_object() && needs_much(scene.value("environment", Json()))) {
        return true;
    }
    const Json materials = scene.is_object() ? scene.value("materials", Json()) : Json();
    if (materials.is_object() && std::any_of(materials.begin(), materials.end(), shows_image)) {
        return true;
    }
    const Json objects = scene.is_object() ? scene.value("objects", Json()) : Json();
    return objects.is_array() &&
           std::any_of(objects.begin(), objects.end(), [](const Json& object) { return needs_much(object); });
}

template <class Real>
void render(const Scene& scene, const RenderSettings& settings) {
    using Generic = Config<Real, all_features | samplers | traversals>;
    const SceneBuffers<Real> buffers(scene, settings);
    Film film(settings.width, settings.height, radiance_bound(scene, settings), 1);
    PathCounters counters;
    for (std::uint32_t pixel = 0; pixel < settings.width * settings.height; ++pixel) {
        PixelSum<Generic> sum;
        integrator::depth_first::trace<Generic>(buffers.view(), film.view(), sum, pixel, 0, nullptr, false, counters);
        sum.finish(film.view(), pixel);
    }
    require(film.faults().nonfinite == 0 && film.faults().negative == 0, faults_text(film.faults()));
}

void render_small(Scene scene) {
    for (SceneMaterial& material : scene.materials) {
        material.max_scatterings = std::min(material.max_scatterings, most_scatterings);
    }
    RenderSettings settings = default_settings(scene);
    settings.width = settings.height = 2;
    settings.depth = std::min(settings.depth, most_depth);
    render<float>(scene, settings);
    render<double>(scene, settings);
    settings.final_bounce = true;
    render<float>(scene, settings);
    settings.final_bounce = false;
    settings.next_event = true;
    settings.mis_exponent = 2;
    settings.roulette_start = 1;
    render<float>(scene, settings);
}

}  // namespace
}  // namespace pt::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    pt::fuzz::accept_or_refuse([&] {
        const std::string text = pt::fuzz::text_of(data, size);
        if (pt::fuzz::needs_much(text)) {
            return;
        }
        const pt::Scene scene = pt::parse_scene(text, "scene.json");
        (void)pt::features_of(scene);
        (void)pt::shortcuts_of(scene);
        if (scene.objects.size() <= pt::fuzz::most_objects) {
            pt::fuzz::render_small(scene);
        }
    });
    return 0;
}
