// Everything a render on the device needs, made before its clock starts and freed on every path out: compiled kernels,
// one arena, the uploaded scene, the film, the queue and the choices that work on it.
#pragma once

#include <memory>

#include "harness/cuda/device_scene.h"
#include "harness/cuda/handles.h"
#include "harness/cuda/queue_memory.h"
#include "harness/render/checkpoints.h"
#include "harness/scene/scene_buffers.h"

namespace pt::cuda {

template <class Real>
class RenderCell {
public:
    RenderCell(const Scene& scene, const RenderRequest& request, const RenderSettings& settings,
               const KernelChoice& kernel, const FilmView& film);
    ~RenderCell();
    RenderCell(const RenderCell&) = delete;
    RenderCell& operator=(const RenderCell&) = delete;

    // Runs the integrator, in parts where the request has checkpoints, and adds up the times of `result`.
    void run(RenderResult& result);
    // Reads film and counters back.
    void collect(RenderResult& result);

private:
    void make_handles();
    void describe_job(const RenderSettings& settings);
    void make_choices();
    CellContext context();
    void reserve(Arena& arena);
    void upload();
    void run_part(const RenderPart& part, RenderResult& result);

    const Scene& scene_;
    const RenderRequest& request_;
    VariantTraits traits_;
    const Integrator& integrator_;
    SceneBuffers<Real> buffers_;
    DeviceScene<Real> device_scene_;
    QueueNeeds queue_needs_;
    FilmView host_film_;
    CudaFacts facts_;
    std::uint64_t choice_launches_ = 0, choice_waits_ = 0;
    std::unique_ptr<Arena> arena_;
    PinnedWords pinned_;
    Stream stream_;
    Event begin_, end_;
    std::unique_ptr<Compaction> compaction_;
    std::unique_ptr<Sorting> sorting_;
    StageEvents stages_;
    Job job_;
};

}  // namespace pt::cuda
