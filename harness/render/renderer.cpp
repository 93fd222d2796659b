#include "harness/render/renderer.h"

#include <new>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "harness/crash.h"
#include "harness/failure.h"
#include "harness/render/adjoint_table.h"
#include "harness/render/checkpoints.h"
#include "harness/render/process_clock.h"
#include "variants/cpu/parallel_for.h"
#include "variants/variant_name.h"

namespace pt {

namespace {

// One path queue per layout for the whole process, so that a timed render finds its memory allocated.
PathQueue& queue_for(const Variant& variant) {
    static std::map<std::string, PathQueue> queues;
    const auto [position, inserted] = queues.try_emplace(variant[axes::layout]);
    if (inserted) {
        position->second.paths = Registry::instance().at(axes::layout, variant).hook.layout();
    }
    return position->second;
}

void run(const KernelChoice& kernel, RenderJobIn<float>& job) { kernel.render(job); }
void run(const KernelChoice& kernel, RenderJobIn<double>& job) { kernel.render_in_double(job); }

template <class Real>
RenderResult render_in(const Scene& scene, const RenderRequest& request, const KernelChoice& kernel) {
    const Registry& registry = Registry::instance();
    const std::vector<RenderPart> parts = parts_of(request);
    const RenderSettings settings = settings_for(request, kernel);

    SceneBuffers<Real> buffers(scene, settings, Acceleration::of(request.variant, Backend::cpu));
    const LearnedAdjoint<Real> learned = learned_adjoint<Real>(scene, settings);
    buffers.set_adjoint(learned.cache());
    const std::uint64_t film_samples = request.film_samples != 0 ? request.film_samples : request.samples;
    RenderResult result{.film = Film(settings.width, settings.height, radiance_bound(scene, settings), film_samples),
                        .work = {},
                        .stages = {},
                        .needed = kernel.needed,
                        .compiled = kernel.compiled,
                        .wall_ms = learned.wall_ms,
                        .cpu_ms = learned.cpu_ms};
    const auto compaction = registry.at(axes::compaction, request.variant).hook.compaction();
    const auto sorting = registry.at(axes::sorting, request.variant).hook.sorting();
    PathQueue& queue = queue_for(request.variant);

    RenderJobIn<Real> job;
    job.scene = buffers.view();
    job.film = result.film.view();
    job.queue = &queue;
    job.compaction = compaction.get();
    job.sorting = sorting.get();
    job.stages = request.instrument ? &result.stages : nullptr;
    job.health = health_request(scene, buffers.file_index());
    job.health.counters = &result.health;

    FirstBounceCache<Real> cache;
    cache.rays = registry.at(axes::first_bounce, request.variant).hook.first_bounce(request.variant, Backend::cpu);
    for (const RenderPart& part : parts) {
        wake_threads();
        const double cpu_start = process_cpu_ms();
        const auto start = std::chrono::steady_clock::now();
        // A render's time includes allocating and filling its first-bounce cache; path queues outlive renders.
        if (cache.rays > 0 && job.cache == nullptr) {
            cache.hits.resize(std::size_t{settings.width} * settings.height * cache.rays);
            job.cache = &cache;
        }
        job.first_sample = request.first_sample + part.done;
        job.samples = part.samples;
        run(kernel, job);
        result.wall_ms += std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
        result.cpu_ms += process_cpu_ms() - cpu_start;
        result.device_ms = result.wall_ms;
        report_checkpoint(request, part, result);
    }
    result.work = job.work;
    result.meshes = facts_of(buffers.meshes());
    add_facts(result.meshes, buffers.tree().get());
    return result;
}

RenderResult render_unguarded(const Scene& scene, const RenderRequest& request) {
    const KernelChoice kernel = choose_kernel(scene, request.variant);
    return kernel.render_in_double != nullptr ? render_in<double>(scene, request, kernel)
                                              : render_in<float>(scene, request, kernel);
}

template <class Render>
std::vector<FeatureSet> feature_sets_of(const std::map<FeatureSet, Render>& kernels) {
    std::vector<FeatureSet> sets;
    for (const auto& [features, render] : kernels) {
        sets.push_back(features);
    }
    return sets;
}

}  // namespace

std::uint64_t triangles_of(const Scene& scene) {
    std::uint64_t triangles = 0;
    for (const SceneObject& object : scene.objects) {
        triangles += object.mesh != SceneObject::no_mesh ? scene.meshes[object.mesh]->triangles.size() : 0;
    }
    return triangles;
}

std::ptrdiff_t objects_with_meshes(const Scene& scene) {
    return std::count_if(scene.objects.begin(), scene.objects.end(),
                         [](const SceneObject& object) { return object.mesh != SceneObject::no_mesh; });
}

Variant fast_reference_on(const Scene& scene, const Variant& variant, Backend backend) {
    const Registry& registry = Registry::instance();
    Variant reference = registry.reference(variant, backend);
    if (scene.meshes.empty() || registry.at(axes::accelerator, reference, backend).descriptor.claim != Claim::bitwise) {
        return reference;
    }
    for (const Choice* choice : registry.choices(axes::accelerator, backend)) {
        if (traits_in<AcceleratorTraits>(choice->descriptor).checks_large_scenes) {
            reference.set(axes::accelerator, std::string(choice->descriptor.name));
        }
    }
    if (objects_with_meshes(scene) > most_objects_in_turn) {
        reference.set(axes::levels, "two_level");
    }
    return reference;
}

Acceleration quick_acceleration(const Scene& scene) {
    const Variant baseline = Registry::instance().baseline(Backend::cpu);
    return Acceleration::of(fast_reference_on(scene, baseline, Backend::cpu), Backend::cpu);
}

Variant reference_on(const Scene& scene, const Variant& variant, Backend backend) {
    return triangles_of(scene) > most_by_brute_force ? fast_reference_on(scene, variant, backend)
                                                     : Registry::instance().reference(variant, backend);
}

std::vector<Variant> rendered_to_check(const Scene& scene, const Variant& variant, Backend backend) {
    const Variant twin = exact_twin(variant, backend);
    const Variant reference = reference_on(scene, twin, backend);
    std::vector<Variant> rendered{variant, twin, reference};
    if (fp_relaxed(variant, backend)) {
        rendered.push_back(variant_of_mean(variant, backend));
    }
    if (claim_of(twin, backend) == Claim::statistical) {
        rendered.push_back(variant_of_mean(reference, backend));
    }
    return rendered;
}

RenderSettings settings_for(const RenderRequest& request, const KernelChoice& kernel) {
    RenderSettings settings = request.settings;
    settings.final_bounce = contains(kernel.needed, Feature::final_bounce);
    settings.next_event = contains(kernel.needed, Feature::next_event);
    settings.mis_exponent = contains(kernel.needed, Feature::multiple_importance)
                                ? tunable(request.variant, "mis_exponent", request.backend)
                                : 0;
    settings.light_sampling = light_sampling_in(kernel.needed);
    if (settings.light_sampling == LightSampling::automatic) {
        settings.near_light = static_cast<std::uint16_t>(tunable(request.variant, "near_light", request.backend));
    }
    settings.light_selection = light_selection_in(kernel.needed);
    settings.one_sample = contains(kernel.needed, Feature::one_sample);
    settings.roulette_start = contains(kernel.needed, Feature::russian_roulette)
                                  ? tunable(request.variant, "roulette_start", request.backend)
                                  : 0;
    settings.guided_share = contains(kernel.needed, Feature::guided_walk)
                                ? tunable(request.variant, "guided_percent", request.backend) * 0.01
                                : 0;
    if (contains(kernel.needed, Feature::adjoint_roulette)) {
        const auto value = [&](std::string_view name) { return tunable(request.variant, name, request.backend); };
        settings.adjoint = {value("adjoint_paths"), value("adjoint_cells"), value("weight_window"),
                            contains(kernel.needed, Feature::splitting) ? value("most_branches") : 1};
    }
    settings.sampler = kernel.needed & samplers;
    return settings;
}

HealthRequest health_request(const Scene& scene, const std::vector<std::uint32_t>& file_index) {
    HealthRequest request;
    request.knows_sides = scene.camera.aperture_radius == 0;
    for (std::size_t object = 0; object < file_index.size(); ++object) {
        const SceneObject& body = scene.objects[file_index[object]];
        request.knows_sides = request.knows_sides && body.velocity == Vec3d(0.0);
        if (object < 64 && contains_point(scene, body, scene.camera.eye)) {
            request.around_eye |= BodySet{1} << object;
        }
    }
    return request;
}

std::string KernelChoice::note() const {
    const FeatureSet surplus = compiled & (all_features | samplings) & ~needed;
    return surplus == 0 ? "exact" : fmt::format("has {} for nothing", fmt::join(feature_names(surplus), ", "));
}

KernelChoice choose_kernel(const Scene& scene, const Variant& variant, Backend backend) {
    const Registry& registry = Registry::instance();
    const FeatureSet needed = features_of(scene) | features_asked(variant, backend);
    // On CUDA a kernel is compiled for exactly the features needed. Shortcut features are faster ways to the bits of
    // the plain formulas, so kernels with other formulas do without them.
    const FeatureSet shortcuts_here = (needed & formulas) == 0 ? shortcuts_of(scene) : no_features;
    KernelOffer offer{needed,
                      shortcuts_here,
                      {needed, needed | shortcuts_here,
                       all_features | (needed & (samplings | formulas | traversals | mesh_levels | path_trees))}};
    const Hook& integrator = registry.at(axes::integrator, variant, backend).hook;
    const bool in_double = traits_of(variant, backend).precision.is_double();
    if (backend == Backend::cpu) {
        offer.compiled =
            in_double ? feature_sets_of(integrator.integrator_in_double) : feature_sets_of(integrator.integrator);
    }
    const FeatureSet chosen =
        registry.at(axes::specialisation, variant, backend).hook.specialisation(offer, variant, backend);
    if (!is_superset(chosen, needed)) {
        throw std::logic_error("a kernel was chosen that lacks a feature of the scene");
    }
    if (backend == Backend::cuda) {
        return {needed, chosen, nullptr};
    }
    if (in_double) {
        return {needed, chosen, nullptr, integrator.integrator_in_double.at(chosen)};
    }
    return {needed, chosen, integrator.integrator.at(chosen)};
}

namespace {

RenderRequested& cuda_render() {
    static RenderRequested render = nullptr;
    return render;
}

}  // namespace

bool set_cuda_render(RenderRequested render) {
    cuda_render() = render;
    return true;
}

RenderResult render(const Scene& scene, const RenderRequest& request) {
    (void)parts_of(request);  // parts_of() throws if checkpoints are invalid, before anything is rendered
    if (request.backend == Backend::cuda) {
        return cuda_render()(scene, request);
    }
    try {
        return render_unguarded(scene, request);
    } catch (const std::bad_alloc&) {
        throw MachineError(fmt::format("out of memory: {} of {} at {}x{}", shown_name(request.variant, request.backend),
                                       scene.name, request.settings.width, request.settings.height));
    }
}

std::string description_of(const Scene& scene, const RenderRequest& request) {
    return fmt::format("{} on {}, {}, {}x{}, {} spp, seed {}", shown_name(request.variant, request.backend), scene.name,
                       to_string(request.backend), request.settings.width, request.settings.height, request.samples,
                       request.settings.seed);
}

RenderResult render_named(const Scene& scene, const RenderRequest& request) {
    const AtWork at_work(description_of(scene, request));
    return render(scene, request);
}

}  // namespace pt
