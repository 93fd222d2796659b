// What goes between ranks as JSON: a render that rank 0 asks for, and the work that a rank did.
#pragma once

#include "harness/json_reader.h"
#include "harness/render/renderer.h"

namespace pt {

// A render as the other ranks need to know it: of its settings, all that the variant does not decide, without
// checkpoints.
Json task_of(const Scene& scene, const RenderRequest& request);
RenderRequest request_in(const Json& task);

Json json_of(const WorkCounters& work);
WorkCounters work_in(const Json& words);

}  // namespace pt
