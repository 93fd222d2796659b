// The JSON messages between MPI ranks: a render that rank 0 requests, and the work counters that a rank returns.
#pragma once

#include "harness/json_reader.h"
#include "harness/render/renderer.h"

namespace pt {

// A render request as JSON: variant, backend, size, depth, seed and sample range, without checkpoints.
Json task_of(const Scene& scene, const RenderRequest& request);
RenderRequest request_in(const Json& task);

Json json_of(const WorkCounters& work);
WorkCounters work_in(const Json& words);

}  // namespace pt
