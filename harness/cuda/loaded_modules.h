// Modules stay loaded: a variant's kernels are compiled, or read from the cache on disk, once a process.
#pragma once

#include "harness/render/renderer.h"
#include "variants/cuda/runtime/module.h"

namespace pt::cuda {

// The loaded module of a request, valid until the process ends. The time that it took is added to `facts`.
const Module& loaded_module(const ModuleRequest& request, CudaFacts& facts);

}  // namespace pt::cuda
