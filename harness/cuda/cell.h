// Everything that a render on the device needs, made before its clock starts and freed even if the render fails:
// compiled kernels, an arena of device memory, the scene, the film, and the integrator with its queue's stages.
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "harness/cuda/device_scene.h"
#include "harness/render/adjoint_table.h"
#include "harness/render/checkpoints.h"
#include "harness/render/device_shares.h"
#include "harness/scene/scene_buffers.h"
#include "variants/cuda/integrator.h"
#include "variants/cuda/runtime/handles.h"

namespace pt::cuda {

template <class Real>
class RenderCell {
public:
    // Allocates and compiles what the current device needs to render the image rows `rows`. The same device must be
    // current whenever the object is used.
    RenderCell(const Scene& scene, const RenderRequest& request, const RenderSettings& settings,
               const KernelChoice& kernel, const FilmView& film, const Rows& rows = {});
    ~RenderCell();
    RenderCell(const RenderCell&) = delete;
    RenderCell& operator=(const RenderCell&) = delete;

    // Renders the whole request, in parts if it has checkpoints, and adds the times to `result`.
    void run(RenderResult& result);
    // Renders the pieces (ranges of samples) that `next` returns until it returns nothing, and waits for them. Each
    // piece is enqueued while the previous one runs. `enqueue_more` enqueues work to follow the pieces, which is
    // neither awaited nor timed. Returns the device time in ms.
    double run_pieces(
        const std::function<std::optional<SampleRange>()>& next, const std::function<void()>& enqueue_more = [] {});
    // Whether the device has rendered all pieces (ranges of samples); to be called once all are enqueued.
    bool has_rendered() const { return is_ready(cudaEventQuery(end_.get())); }
    // Downloads the film and the counters of the render from the device.
    void collect(RenderResult& result);
    // Downloads the counters of the render from the device, but not the film.
    void collect_counts(RenderResult& result);
    // Adds to the render's times the learning for roulette that preceded it, during which the device was idle.
    void add_learning(RenderResult& result) const;
    FilmFaults faults() const;
    const JobOf<Real>& job() const { return job_; }

private:
    void make_handles();
    void describe_job(const RenderSettings& settings);
    void make_integrator();
    CellContext context(const Choice& stage);
    void reserve(Arena& arena);
    void upload();
    void run_part(const RenderPart& part, RenderResult& result);

    const Scene& scene_;
    const RenderRequest& request_;
    VariantTraits traits_;
    const IntegratorHook& integrator_hook_;
    FeatureSet features_;  // features compiled into the render's kernels
    Layout layout_;
    SceneBuffers<Real> buffers_;
    LearnedAdjoint<Real> learned_;
    DeviceScene<Real> device_scene_;
    FilmView host_film_;
    Rows rows_;
    CudaFacts facts_;
    std::uint64_t choice_launches_ = 0, choice_waits_ = 0;
    std::unique_ptr<Arena> arena_;
    Stream stream_;
    Event begin_, end_;
    Event enqueued_[2];  // CUDA events behind the last two ranges of samples enqueued
    StageEvents stages_;
    JobOf<Real> job_;
    std::unique_ptr<Integrator> integrator_;
};

}  // namespace pt::cuda
