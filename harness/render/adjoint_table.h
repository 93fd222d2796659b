// The estimates by which kernels/adjoint.h ends and splits paths. They are learned before a render from paths of its
// own estimator, without roulette, whose random numbers are none of the render's: so they are independent of its
// samples. The same table on any number of threads and for every backend, and of a scene scaled by a power of two.
#pragma once

#include <memory>
#include <vector>

#include "harness/scene/scene_buffers.h"
#include "kernels/adjoint.h"

namespace pt {

// A path of the learning at a vertex, before it scatters; colours as sums of their channels.
struct AdjointRecord {
    Vec3<float> position;  // relative to the eye
    std::uint32_t side;    // nearest_side of the normal
    std::uint32_t segment;
    float carried;  // throughput
    float brought;  // from there to the path's end
};

// The light that a path brought from its first vertex on: what the camera sees at once is no matter of chance.
struct AdjointStart {
    std::uint32_t pixel;
    float brought;
};

// The records of paths, one path after the other.
struct AdjointRecords {
    std::vector<AdjointRecord> vertices;
    std::vector<AdjointStart> starts;
};

// Traces paths of the scene as the settings have it, and records what they bring. What is not finite is left out.
AdjointRecords learn_adjoint(const Scene& scene, const RenderSettings& settings);

template <class Real>
struct AdjointTable {
    AdjointCache<Real> cache{};  // with pointers into the vectors
    std::vector<float> by_place, by_segment, by_pixel;

    AdjointTable() = default;
    AdjointTable(const AdjointTable&) = delete;
    AdjointTable& operator=(const AdjointTable&) = delete;
};

// Makes the estimates from records of paths; null where the paths brought nothing.
template <class Real>
std::unique_ptr<const AdjointTable<Real>> adjoint_table(const AdjointRecords& records, const RenderSettings& settings);

// The estimates with the time that both steps took: a render pays for them. Its scene's trees are made before the clock
// starts, as a render's own are.
template <class Real>
struct LearnedAdjoint {
    std::unique_ptr<const AdjointTable<Real>> table;  // null also where the settings ask for none
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
