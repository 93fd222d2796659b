// Everything a render on the device needs, made before its clock starts and freed on every path out: compiled kernels,
// one arena, the uploaded scene, the film, the integrator with the choices that work on its queue.
#pragma once

#include <memory>

#include "harness/cuda/device_scene.h"
#include "harness/render/checkpoints.h"
#include "harness/scene/scene_buffers.h"
#include "variants/cuda/handles.h"
#include "variants/cuda/integrator.h"

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
    void make_integrator();
    CellContext context(const Hooks& choice);
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
    DeviceScene<Real> device_scene_;
    FilmView host_film_;
    CudaFacts facts_;
    std::uint64_t choice_launches_ = 0, choice_waits_ = 0;
    std::unique_ptr<Arena> arena_;
    Stream stream_;
    Event begin_, end_;
    StageEvents stages_;
    JobOf<Real> job_;
    std::unique_ptr<Integrator> integrator_;
};

}  // namespace pt::cuda
