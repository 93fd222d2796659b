// Estimates of the radiance that paths still gather, by which kernels/adjoint.h ends and splits paths. They are learned
// before a render from paths of the same estimator without roulette, with random numbers of their own, so that they are
// independent of the render's samples. The table is the same for any number of threads, for every backend, and for a
// scene scaled by a power of two.
#pragma once

#include <memory>
#include <vector>

#include "harness/scene/scene_buffers.h"
#include "kernels/adjoint.h"

namespace pt {

// A vertex of a learning path, before the path scatters there; `carried` and `brought` are sums of colour channels.
struct AdjointRecord {
    Vec3<float> position;  // vertex position relative to the eye
    std::uint32_t side;    // direction that the surface normal is nearest to (nearest_side)
    std::uint32_t segment;
    float carried;  // throughput of the path at this vertex
    float brought;  // radiance gathered from this vertex to the path's end
};

// The radiance that a path gathered from its first vertex on, without light that the camera sees directly.
struct AdjointStart {
    std::uint32_t pixel;
    float brought;
};

// Records of learning paths: all vertices and starts, one path after the other.
struct AdjointRecords {
    std::vector<AdjointRecord> vertices;
    std::vector<AdjointStart> starts;
};

// Traces learning paths through the scene with these settings and records what they gather, if it is finite.
AdjointRecords learn_adjoint(const Scene& scene, const RenderSettings& settings);

template <class Real>
struct AdjointTable {
    AdjointCache<Real> cache{};  // table as kernels see it, with pointers into the vectors below
    std::vector<float> by_place, by_segment, by_pixel;

    AdjointTable() = default;
    AdjointTable(const AdjointTable&) = delete;
    AdjointTable& operator=(const AdjointTable&) = delete;
};

// Computes the table of estimates from the records of learning paths; null if the paths gathered no radiance.
template <class Real>
std::unique_ptr<const AdjointTable<Real>> adjoint_table(const AdjointRecords& records, const RenderSettings& settings);

// The table of estimates with the time spent on learning it, which counts as time of the render. Building the
// acceleration structures is not counted, as in a render.
template <class Real>
struct LearnedAdjoint {
    std::unique_ptr<const AdjointTable<Real>> table;  // null if no estimates are needed or paths gathered no light
    double wall_ms = 0, cpu_ms = 0;

    const AdjointCache<Real>* cache() const { return table != nullptr ? &table->cache : nullptr; }
};
template <class Real>
LearnedAdjoint<Real> learned_adjoint(const Scene& scene, const RenderSettings& settings);

extern template std::unique_ptr<const AdjointTable<float>> adjoint_table(const AdjointRecords&, const RenderSettings&);
extern template std::unique_ptr<const AdjointTable<double>> adjoint_table(const AdjointRecords&, const RenderSettings&);
extern template LearnedAdjoint<float> learned_adjoint(const Scene&, const RenderSettings&);
extern template LearnedAdjoint<double> learned_adjoint(const Scene&, const RenderSettings&);

}  // namespace pt
