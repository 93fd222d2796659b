// A render on several GPUs of this host: on each a cell of its own, with the whole scene and an integer film, driven by
// a thread of its own; NCCL adds up the films on the first GPU. Samples and pixels have their random numbers and the
// sums are integers, so the film is one GPU's bit for bit.
#pragma once

#include "harness/render/renderer.h"

namespace pt::cuda {

// Fills `result`, whose film is there. Times: all devices start together; wall_ms is until the last one has rendered
// and, after that, until the first one has the sum.
template <class Real>
void render_on_devices(const Scene& scene, const RenderRequest& request, const RenderSettings& settings,
                       const KernelChoice& kernel, RenderResult& result);

}  // namespace pt::cuda
