#include "harness/cuda/kernel_request.h"

#include <fmt/format.h>

#include "harness/cuda/choices.h"
#include "harness/cuda/device_scene.h"
#include "harness/render/renderer.h"
#include "harness/scene/scene_buffers.h"

namespace pt::cuda {

namespace {

ModuleRequest request_for(const Variant& variant, const std::string& source, const std::string& architecture) {
    ModuleRequest request;
    request.name = source;
    request.includes = {source};
    request.real = hooks("precision", variant).real;
    request.layout = variant["layout"];
    request.sort_key = variant["sort_key"];
    request.architecture = architecture;
    return request;
}

template <class Real>
void describe_scene(const Scene& scene, bool bakes, ModuleRequest& request) {
    const SceneBuffers<Real> buffers(scene, default_settings(scene));
    for (std::string& define : scene_defines(buffers.view(), request.features)) {
        request.defines.push_back(std::move(define));
    }
    if (bakes) {
        request.prelude = baked_text(buffers.view());
    }
}

}  // namespace

std::string integrator_source(const Variant& variant) {
    const char* const own = hooks("integrator", variant).integrator.source;
    return own != nullptr ? own : "variants/integrator/" + variant["integrator"] + ".cuh";
}

ModuleRequest module_request(const Scene& scene, const Variant& variant, const std::string& architecture) {
    const FeatureSet features = choose_kernel(scene, variant, Backend::cuda).compiled;
    ModuleRequest request = request_for(variant, integrator_source(variant), architecture);
    const Integrator& integrator = hooks("integrator", variant).integrator;
    const VariantTraits traits = traits_of(variant, Backend::cuda);
    request.features = features;
    request.options = hooks("arithmetic", variant).options;
    request.defines = {
        fmt::format("-DPT_BLOCK={}", tunable(variant, "block", Backend::cuda)),
        fmt::format("-DPT_MIN_BLOCKS={}", tuned(variant, "min_blocks", 0) / (traits.precision.is_double() ? 2 : 1)),
        fmt::format("-DPT_CACHED={}", kept_rays(variant) > 0 ? 1 : 0),
        fmt::format("-DPT_SHADING_FMAS={}", tuned(variant, "shading_fmas", 0))};
    const bool bakes = hooks("specialisation", variant).bakes_scene;
    if (traits.precision.is_double()) {
        describe_scene<double>(scene, bakes, request);
    } else {
        describe_scene<float>(scene, bakes, request);
    }
    if (integrator.defines != nullptr) {
        const std::vector<std::string> more = integrator.defines(variant);
        request.defines.insert(request.defines.end(), more.begin(), more.end());
    }
    if (!traits.integrator.has_queue) {
        request.layout = "aos";  // not used: one compilation serves
    }
    if (!integrator.stores_hits) {
        request.sort_key = "material";
    }
    return request;
}

// Stages move paths and count them; they do no arithmetic on them, so neither features nor arithmetic matter.
ModuleRequest stage_request(const Variant& variant, const std::string& source, const std::string& architecture) {
    ModuleRequest request = request_for(variant, source, architecture);
    request.features = no_features;
    request.sort_key = "material";
    request.defines = {"-DPT_BLOCK=256",      "-DPT_MIN_BLOCKS=0",  "-DPT_CACHED=0",
                       "-DPT_SHADING_FMAS=0", "-DPT_SCENE_BYTES=0", "-DPT_FIXED_COUNTS=0"};
    return request;
}

}  // namespace pt::cuda
