// Everything a render on the device needs, made before its clock starts and freed on every path out: compiled kernels,
// one arena, the uploaded scene, the film, the queue and the choices that work on it.
#pragma once

#include <memory>

#include "harness/render/checkpoints.h"
#include "variants/cuda/job.h"

namespace pt::cuda {

// What is compiled for a variant of a scene on a GPU ("sm_90"), for an integrator and the sources that choices ask for.
ModuleRequest module_request(const Scene& scene, const Variant& variant, const std::string& architecture);
ModuleRequest stage_request(const Variant& variant, const std::string& source, const std::string& architecture);
// The embedded source of the variant's integrator.
std::string integrator_source(const Variant& variant);

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
    void run_part(const RenderPart& part, RenderResult& result);
    void download_film(Film& film);
    void reserve(Arena& arena);
    void reserve_queue(Arena& arena);
    bool copies_whole_paths() const;
    PathFields carried_fields() const;
    void upload();
    CellContext context();
    const Module& module(const ModuleRequest& request);

    const Scene& scene_;
    const RenderRequest& request_;
    KernelChoice kernel_;
    SceneBuffers<Real> buffers_;
    Job job_;
    SceneView<Real> view_;  // the scene on the device
    StageEvents stages_;
    std::unique_ptr<Compaction> compaction_;
    std::unique_ptr<Sorting> sorting_;
    std::unique_ptr<Arena> arena_;
    FilmView host_film_;
    Layout layout_;
    CudaFacts facts_;
    cudaEvent_t begin_ = nullptr, end_ = nullptr;
    std::uint64_t choice_launches_ = 0, choice_waits_ = 0;
};

}  // namespace pt::cuda
