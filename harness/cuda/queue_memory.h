// The memory of a wavefront's queue: how many paths it holds, what each of them carries, and what the compaction and
// the sorting of the variant need beside the paths.
#pragma once

#include "harness/render/renderer.h"
#include "variants/cuda/job.h"

namespace pt::cuda {

// What it depends on, beside the job.
struct QueueNeeds {
    Layout layout = {};
    std::size_t real_bytes = 4;
    std::size_t hit_bytes = 0;  // 0: hits are not stored
    FeatureSet features = no_features;
    std::vector<unsigned char> object_class;  // as in Queue
};

// By object number.
template <class Real>
std::vector<unsigned char> object_classes(const SceneView<Real>& scene);

// Fills job.queue, and tells `facts` what a path takes. Throws Error if there are too many.
void reserve_queue(Arena& arena, const QueueNeeds& needs, Job& job, CudaFacts& facts);
// Brings it into the state in which a render starts. Waits for the device.
void upload_queue(const QueueNeeds& needs, const Job& job);

}  // namespace pt::cuda
