// Keeps modules loaded, so that a process compiles a variant's kernels, or reads them from the disk cache, only once.
#pragma once

#include "harness/render/renderer.h"
#include "variants/cuda/runtime/module.h"

namespace pt::cuda {

// Returns the loaded module of a request, valid until the process ends, and adds the loading time to `facts`.
const Module& loaded_module(const ModuleRequest& request, CudaFacts& facts);

}  // namespace pt::cuda
