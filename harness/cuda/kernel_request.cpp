#include "harness/cuda/kernel_request.h"

#include <fmt/format.h>

#include "harness/cuda/choices.h"
#include "harness/cuda/device_scene.h"
#include "harness/render/renderer.h"
#include "harness/scene/scene_buffers.h"
#include "variants/cuda/device/parameters.h"
#include "variants/cuda/stages.h"

namespace pt::cuda {

namespace {

ModuleRequest request_for(const Variant& variant, const std::string& source, const std::string& architecture) {
    ModuleRequest request;
    request.name = source;
    request.includes = {source};
    request.real = hooks(axes::precision, variant).real;
    request.layout = variant[axes::layout];
    request.sort_key = variant[axes::sort_key];
    request.accelerator = variant[axes::accelerator];
    const VariantTraits traits = traits_of(variant, Backend::cuda);
    if (!traits.traversal.is_accelerators_own || !traits.traversal_stack.is_in_thread) {
        request.traversal = variant[axes::traversal];
        request.traversal_stack = variant[axes::traversal_stack];
    }
    request.architecture = architecture;
    return request;
}

template <class Real>
void describe_scene(const Scene& scene, bool bakes, ModuleRequest& request) {
    const SceneBuffers<Real> buffers(scene, default_settings(scene));
    request.scene = scene_place(buffers.view(), request.config.features, bakes);
    request.config.constant_scene_bytes = request.scene == scene_in_constant ? constant_bytes : 16;
    fix_counts(buffers.view(), request.config);
    if (bakes) {
        request.prelude = baked_text(buffers.view());
    }
}

template <class Real>
std::vector<KernelSignature> kernels_of(const IntegratorHook& integrator, const KernelConfig& config,
                                        const std::vector<KernelPart>& parts) {
    std::vector<KernelSignature> kernels = integrator.kernels(sizeof(Real));
    for (const KernelPart& part : parts) {
        kernels.push_back(sizeof(Real) == sizeof(double) ? part.double_kernel : part.single_kernel);
    }
    if (config.keeps_first_hits) {
        kernels.push_back(kernel_of<FillCacheParameters<Real>>(false));
    }
    return kernels;
}

std::vector<KernelPart> parts_of(const IntegratorHook& integrator, const Variant& variant, FeatureSet features) {
    std::vector<KernelPart> parts;
    if (integrator.walks.source != nullptr && contains(features, Feature::subsurface) &&
        tunable(variant, "walks_apart", Backend::cuda) != 0) {
        parts.push_back(integrator.walks);
    }
    if (integrator.meshes.source != nullptr && traits_of(variant, Backend::cuda).traversal.needs_own_kernel) {
        parts.push_back(integrator.meshes);
    }
    return parts;
}

}  // namespace

std::string integrator_source(const Variant& variant) {
    const char* const own = hooks(axes::integrator, variant).integrator.source;
    return own != nullptr ? own : "variants/integrator/" + variant[axes::integrator] + ".cuh";
}

ModuleRequest module_request(const Scene& scene, const Variant& variant, const std::string& architecture) {
    ModuleRequest request = request_for(variant, integrator_source(variant), architecture);
    const IntegratorHook& integrator = hooks(axes::integrator, variant).integrator;
    const VariantTraits traits = traits_of(variant, Backend::cuda);
    const bool is_double = traits.precision.is_double();
    request.options = hooks(axes::arithmetic, variant).options;
    request.pixels = traits.partition.is_by_rows ? "by_row" : "all";
    request.config = {.features = choose_kernel(scene, variant, Backend::cuda).compiled,
                      .block = tunable(variant, "block", Backend::cuda),
                      .min_blocks = tuned(variant, "min_blocks", 0) / (is_double ? 2 : 1),
                      .keeps_first_hits = kept_rays(variant) > 0,
                      .shading_fmas = tuned(variant, "shading_fmas", 0)};
    const std::vector<KernelPart> parts = parts_of(integrator, variant, request.config.features);
    for (const KernelPart& part : parts) {
        request.includes.emplace_back(part.source);
    }
    request.kernels = is_double ? kernels_of<double>(integrator, request.config, parts)
                                : kernels_of<float>(integrator, request.config, parts);
    const bool bakes = hooks(axes::specialisation, variant).bakes_scene;
    if (is_double) {
        describe_scene<double>(scene, bakes, request);
    } else {
        describe_scene<float>(scene, bakes, request);
    }
    if (integrator.constants != nullptr) {
        request.constants = integrator.constants(variant);
    }
    for (const char* axis : {axes::traversal, axes::traversal_stack}) {
        for (const Tunable& of : Registry::instance().at(axis, variant, Backend::cuda).descriptor.tunables) {
            request.constants.push_back({std::string(of.name), tunable(variant, of.name, Backend::cuda)});
        }
    }
    if (!traits.integrator.has_queue) {
        request.layout = "aos";  // no queue to lay out: one layout's name saves compilations
    }
    if (!integrator.stores_hits) {
        request.sort_key = "material";
    }
    return request;
}

// Compactions and sorts only move and count paths, so a single compilation serves all features and arithmetics.
ModuleRequest stage_request(const Variant& variant, const Choice& stage, const std::string& architecture) {
    const std::string source = fmt::format("variants/{}/{}.cuh", stage.descriptor.axis, stage.descriptor.name);
    ModuleRequest request = request_for(variant, source, architecture);
    request.sort_key = "material";
    request.accelerator = "brute_force";
    request.traversal = request.traversal_stack = "";
    request.config.block = stage_block;
    request.kernels = stage.hook.cuda.kernels;
    return request;
}

std::vector<const Choice*> stages_of(const Variant& variant) {
    std::vector<const Choice*> stages;
    for (const char* axis : {axes::compaction, axes::sorting}) {
        const Choice& choice = Registry::instance().at(axis, variant, Backend::cuda);
        const bool is_made = choice.hook.cuda.compaction != nullptr || choice.hook.cuda.sorting != nullptr;
        if (is_made && traits_of(variant, Backend::cuda).integrator.has_queue) {
            stages.push_back(&choice);
        }
    }
    return stages;
}

std::vector<ModuleRequest> module_requests(const Scene& scene, const Variant& variant,
                                           const std::string& architecture) {
    std::vector<ModuleRequest> requests{module_request(scene, variant, architecture)};
    for (const Choice* const stage : stages_of(variant)) {
        if (!stage->hook.cuda.kernels.empty()) {
            requests.push_back(stage_request(variant, *stage, architecture));
        }
    }
    return requests;
}

}  // namespace pt::cuda
