#include "harness/cuda/cell.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <type_traits>
#include <utility>

#include "harness/cuda/accounting.h"
#include "harness/cuda/choices.h"
#include "harness/cuda/gpu_rates.h"
#include "harness/cuda/kernel_request.h"
#include "harness/cuda/loaded_modules.h"
#include "harness/render/process_clock.h"
#include "harness/scene/scene_mesh.h"
#include "kernels/path_tree.h"
#include "variants/cuda/runtime/device.h"

namespace pt::cuda {

namespace {

double milliseconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

// A box around all objects, relative to the eye, for sorting keys: meshes have their bounding box, other objects a
// cube around their centre that reaches half the diagonal of their size.
KeyBounds key_bounds(const Scene& scene) {
    Vec3d low(1e300), high(-1e300);
    for (const SceneObject& object : scene.objects) {
        const Vec3d centre = object.translate - scene.camera.eye;
        const double reach = 0.5 * std::sqrt(dot(object.scale, object.scale));
        Vec3d least = centre - Vec3d(reach), greatest = centre + Vec3d(reach);
        if (object.mesh != SceneObject::no_mesh) {
            const Box box = box_round(*scene.meshes[object.mesh], placement_of(object, scene.camera.eye));
            least = {box.low[0], box.low[1], box.low[2]};
            greatest = {box.high[0], box.high[1], box.high[2]};
        }
        for (int axis = 0; axis < 3; ++axis) {
            low[axis] = std::min(low[axis], least[axis]);
            high[axis] = std::max(high[axis], greatest[axis]);
        }
    }
    KeyBounds bounds;
    for (int axis = 0; axis < 3; ++axis) {
        const double extent = high[axis] - low[axis];
        bounds.low[axis] = static_cast<float>(low[axis]);
        bounds.inverse_extent[axis] = extent > 0 ? static_cast<float>(1 / extent) : 0.0f;
    }
    return bounds;
}

// For each object, by number, whether its material is specular (delta): 1 or 0.
template <class Real>
std::vector<unsigned char> object_classes(const SceneView<Real>& scene) {
    std::vector<unsigned char> classes;
    for (std::uint32_t object = 0; object < scene.object_material.size; ++object) {
        const MaterialType type = scene.materials[scene.object_material[object]].type;
        classes.push_back(has_trait(type, material_trait::is_delta) ? 1 : 0);
    }
    return classes;
}

}  // namespace

template <class Real>
RenderCell<Real>::RenderCell(const Scene& scene, const RenderRequest& request, const RenderSettings& settings,
                             const KernelChoice& kernel, const FilmView& film, const Rows& rows)
    : scene_(scene),
      request_(request),
      traits_(traits_of(request.variant, Backend::cuda)),
      integrator_hook_(hooks(axes::integrator, request.variant).integrator),
      features_(kernel.compiled),
      layout_(hooks(axes::layout, request.variant).layout),
      buffers_(scene, settings, Acceleration::of(request.variant, Backend::cuda)),
      learned_(learned_adjoint<Real>(scene, settings)),
      device_scene_(buffers_.view(), buffers_.meshes(), buffers_.tree(), kernel.compiled,
                    hooks(axes::specialisation, request.variant).bakes_scene),
      host_film_(film),
      rows_(rows) {
    buffers_.set_adjoint(learned_.cache());
    facts_.from_cache = true;
    job_.module = &loaded_module(module_request(scene, request.variant, device().architecture()), facts_);
    const auto start = std::chrono::steady_clock::now();
    make_handles();
    describe_job(settings);
    make_integrator();
    Arena measuring;
    reserve(measuring);
    arena_ = std::make_unique<Arena>(measuring.used());
    reserve(*arena_);
    upload();
    facts_.device_bytes = measuring.used() + device_scene_.mesh_bytes();
    facts_.path_state_bytes = integrator_->path_bytes().state;
    facts_.path_bytes = integrator_->path_bytes().everything;
    facts_.threads = job_.block;
    facts_.options = job_.module->image().options;
    integrator_->prepare();
    choice_launches_ = 0;  // capturing the graph counted kernel launches that it did not make
    PT_CUDA_CHECK(cudaStreamSynchronize(job_.stream));
    facts_.prepare_ms = milliseconds_since(start);
}

template <class Real>
RenderCell<Real>::~RenderCell() {
    // A CUDA graph must not be destroyed while the stream still runs it.
    (void)cudaStreamSynchronize(job_.stream);
}

template <class Real>
void RenderCell<Real>::make_handles() {
    stream_ = make_stream();
    begin_ = make_event();
    end_ = make_event();
    for (Event& event : enqueued_) {
        event = make_event();
    }
    job_.stream = stream_.get();
}

template <class Real>
void RenderCell<Real>::describe_job(const RenderSettings& settings) {
    const Variant& variant = request_.variant;
    job_.pixels = settings.width * rows_.count(settings.height);
    job_.image_pixels = settings.width * settings.height;
    job_.longest_path = buffers_.view().longest_path();
    job_.most_branches = traits_.russian_roulette.splits_paths ? most_branches_of_tree : 1;
    job_.materials = buffers_.view().materials.size;
    job_.first_sample = request_.first_sample;
    job_.samples = request_.samples;
    job_.all_samples = request_.samples;
    job_.block = tunable(variant, "block", Backend::cuda);
    job_.multiprocessors = static_cast<std::uint32_t>(device().multiprocessors);
    job_.kept_rays = job_.cache.rays = kept_rays(variant);
    job_.stages = request_.instrument ? &stages_ : nullptr;
}

template <class Real>
void RenderCell<Real>::make_integrator() {
    IntegratorNeeds needs{.variant = request_.variant,
                          .traits = traits_,
                          .features = features_,
                          .key_bounds = key_bounds(scene_),
                          .layout = layout_,
                          .object_class = object_classes(buffers_.view())};
    for (const Choice* const stage : stages_of(request_.variant)) {
        const Hooks& made = stage->hook.cuda;
        if (made.compaction != nullptr) {
            needs.compaction = made.compaction(context(*stage));
        } else {
            needs.sorting = made.sorting(context(*stage));
        }
    }
    if constexpr (std::is_same_v<Real, float>) {
        integrator_ = integrator_hook_.make_single(job_, std::move(needs));
    } else {
        integrator_ = integrator_hook_.make_double(job_, std::move(needs));
    }
}

template <class Real>
CellContext RenderCell<Real>::context(const Choice& stage) {
    CellContext context;
    context.layout = &layout_;
    context.layout_name = request_.variant[axes::layout];
    context.real_bytes = sizeof(Real);
    context.materials = job_.materials;
    context.multiprocessors = job_.multiprocessors;
    context.stream = job_.stream;
    context.tunable = [this](std::string_view name) { return tunable(request_.variant, name, Backend::cuda); };
    context.module = [this, &stage]() -> const Module& {
        return loaded_module(stage_request(request_.variant, stage, device().architecture()), facts_);
    };
    context.launches = &choice_launches_;
    context.host_waits = &choice_waits_;
    return context;
}

template <class Real>
void RenderCell<Real>::reserve(Arena& arena) {
    device_scene_.reserve(arena);
    job_.scene = device_scene_.view();
    job_.film = host_film_;
    job_.film.sums = arena.take<std::int64_t>(std::size_t{3} * job_.image_pixels);
    job_.film.faults = arena.take<FilmFaults>(1);
    job_.totals = arena.take<Totals>(counter_copies);
    job_.health = health_request(scene_, buffers_.file_index());
    job_.health.counters = arena.take<HealthCounters>(1);
    job_.segments.copies = job_.longest_path <= few_segments ? counter_copies : 1;
    const std::size_t segment_counts = std::size_t{job_.longest_path} * job_.segments.copies;
    job_.segments.live = arena.take<std::uint64_t>(segment_counts);
    job_.segments.in_play = arena.take<std::uint64_t>(segment_counts);
    const std::size_t kept_hits = std::size_t{job_.image_pixels} * job_.kept_rays;
    job_.cache.hits = arena.take<StoredHit<Real>>(kept_hits);
    job_.cache.primitives = contains(features_, Feature::mesh) ? arena.take<std::uint32_t>(kept_hits) : nullptr;
    integrator_->reserve(arena);
}

template <class Real>
void RenderCell<Real>::upload() {
    device_scene_.upload(*job_.module, job_.stream);
    if (traits_.partition.is_by_rows) {
        const std::uint32_t rows[] = {rows_.first, rows_.step, job_.pixels};
        PT_CUDA_CHECK(
            cudaMemcpyAsync(job_.module->global("pt_rows"), rows, sizeof rows, cudaMemcpyHostToDevice, job_.stream));
        PT_CUDA_CHECK(cudaStreamSynchronize(job_.stream));  // waits until the local array `rows` has been copied
    }
    clear(job_.film.sums, std::size_t{3} * job_.image_pixels * sizeof(std::int64_t), job_.stream);
    clear(job_.film.faults, sizeof(FilmFaults), job_.stream);
    clear(job_.totals, counter_copies * sizeof(Totals), job_.stream);
    static const HealthCounters healthy;
    PT_CUDA_CHECK(cudaMemcpyAsync(job_.health.counters, &healthy, sizeof healthy, cudaMemcpyHostToDevice, job_.stream));
    const std::size_t segment_bytes = std::size_t{job_.longest_path} * job_.segments.copies * sizeof(std::uint64_t);
    clear(job_.segments.live, segment_bytes, job_.stream);
    clear(job_.segments.in_play, segment_bytes, job_.stream);
    integrator_->upload();
}

// The film, counters, cache and CUDA graph stay on the device between a render's parts, whose ends the host awaits.
template <class Real>
void RenderCell<Real>::run(RenderResult& result) {
    add_learning(result);
    for (const RenderPart& part : parts_of(request_)) {
        run_part(part, result);
        if (is_shown(request_)) {
            download_film(job_, result.film);
            report_checkpoint(request_, part, result);
        }
    }
}

template <class Real>
void RenderCell<Real>::run_part(const RenderPart& part, RenderResult& result) {
    job_.first_sample = request_.first_sample + part.done;
    job_.samples = part.samples;
    const double cpu_start = process_cpu_ms();
    const auto start = std::chrono::steady_clock::now();
    PT_CUDA_CHECK(cudaEventRecord(begin_.get(), job_.stream));
    integrator_->render();
    PT_CUDA_CHECK(cudaEventRecord(end_.get(), job_.stream));
    PT_CUDA_CHECK(cudaStreamSynchronize(job_.stream));
    result.wall_ms += milliseconds_since(start);
    result.cpu_ms += process_cpu_ms() - cpu_start;
    float milliseconds = 0;
    PT_CUDA_CHECK(cudaEventElapsedTime(&milliseconds, begin_.get(), end_.get()));
    result.device_ms += milliseconds;
}

template <class Real>
double RenderCell<Real>::run_pieces(const std::function<std::optional<SampleRange>()>& next,
                                    const std::function<void()>& enqueue_more) {
    PT_CUDA_CHECK(cudaEventRecord(begin_.get(), job_.stream));
    std::size_t pieces = 0;
    for (std::optional<SampleRange> piece = next(); piece; piece = next()) {
        job_.first_sample = piece->first;
        job_.samples = piece->count;
        integrator_->render();
        PT_CUDA_CHECK(cudaEventRecord(enqueued_[pieces % 2].get(), job_.stream));
        pieces += 1;
        if (pieces > 1) {
            PT_CUDA_CHECK(cudaEventSynchronize(enqueued_[pieces % 2].get()));
        }
    }
    PT_CUDA_CHECK(cudaEventRecord(end_.get(), job_.stream));
    enqueue_more();
    PT_CUDA_CHECK(cudaEventSynchronize(end_.get()));
    float milliseconds = 0;
    PT_CUDA_CHECK(cudaEventElapsedTime(&milliseconds, begin_.get(), end_.get()));
    return pieces > 0 ? milliseconds : 0.0;
}

template <class Real>
void RenderCell<Real>::add_learning(RenderResult& result) const {
    result.wall_ms += learned_.wall_ms;
    result.device_ms += learned_.wall_ms;
    result.cpu_ms += learned_.cpu_ms;
}

template <class Real>
FilmFaults RenderCell<Real>::faults() const {
    return download_faults(job_);
}

template <class Real>
void RenderCell<Real>::collect(RenderResult& result) {
    download_film(job_, result.film);
    collect_counts(result);
}

template <class Real>
void RenderCell<Real>::collect_counts(RenderResult& result) {
    const DeviceCounts counts = download_counts(job_, traits_.integrator);
    result.health = counts.health;
    result.work = work_of(job_, traits_.integrator, integrator_->device_work(), counts);
    result.work.launches += choice_launches_;
    result.work.host_waits += choice_waits_;
    if (request_.instrument) {
        result.stages.milliseconds = stages_.milliseconds();
        result.stages.live_paths = reached_segments(counts.live);
        const LeastTraffic traffic = integrator_->least_traffic();
        const std::uint32_t batches = (job_.all_samples - 1) / traffic.samples_in_flight + 1;
        for (const auto& [stage, least] : traffic.by_stage) {
            if (!least.is_known()) {
                continue;
            }
            result.stages.memory_bounds[stage] =
                bound_of(least, result.stages.live_paths, job_.longest_path, batches, copy_rates());
        }
    }
    facts_.kernels = kernel_facts(*job_.module, integrator_hook_.kernels(sizeof(Real)));
    result.cuda = facts_;
    result.meshes = facts_of(buffers_.meshes());
    add_facts(result.meshes, buffers_.tree().get());
}

template class RenderCell<float>;
template class RenderCell<double>;

}  // namespace pt::cuda
