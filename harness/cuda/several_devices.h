// Renders on several GPUs of this host: each has a cell with the whole scene and an integer film, driven by a thread of
// its own, and NCCL sums the films on the first GPU. Random numbers depend only on sample and pixel, and the sums are
// integers, so the film equals that of a single GPU bit for bit.
#pragma once

#include "harness/render/renderer.h"

namespace pt::cuda {

// Renders into the existing film of `result`. All devices start together; wall_ms is the time until the last one has
// rendered, plus the time until the first one has the sum of the films.
template <class Real>
void render_on_devices(const Scene& scene, const RenderRequest& request, const RenderSettings& settings,
                       const KernelChoice& kernel, RenderResult& result);

}  // namespace pt::cuda
