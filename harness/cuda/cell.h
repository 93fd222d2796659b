// Everything a render on the device needs, made before its clock starts and freed on every path out: compiled kernels,
// one arena, the uploaded scene, the film, the integrator with the choices that work on its queue.
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
    // Makes the cell on the current device, which must be current whenever it is used. `rows`: the rows that it
    // renders.
    RenderCell(const Scene& scene, const RenderRequest& request, const RenderSettings& settings,
               const KernelChoice& kernel, const FilmView& film, const Rows& rows = {});
    ~RenderCell();
    RenderCell(const RenderCell&) = delete;
    RenderCell& operator=(const RenderCell&) = delete;

    // Runs the integrator, in parts where the request has checkpoints, and adds up the times of `result`.
    void run(RenderResult& result);
    // Renders what `next` hands out until it hands out nothing, and waits for it. One piece is enqueued while the piece
    // before it runs. `enqueue_more`: what the device goes on with, neither waited for nor timed. Returns the time on
    // the device, ms.
    double run_pieces(
        const std::function<std::optional<SampleRange>()>& next, const std::function<void()>& enqueue_more = [] {});
    // Whether the pieces have been rendered, once they are all enqueued.
    bool has_rendered() const { return is_ready(cudaEventQuery(end_.get())); }
    // Reads film and counters back.
    void collect(RenderResult& result);
    // Reads the counters back, but not the film.
    void collect_counts(RenderResult& result);
    // Adds what was spent before anything could be rendered, while the device waited.
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
    FeatureSet features_;  // of the kernels
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
    Event enqueued_[2];  // after the last piece, and the one before it
    StageEvents stages_;
    JobOf<Real> job_;
    std::unique_ptr<Integrator> integrator_;
};

}  // namespace pt::cuda
