// Compiles the kernels of many variants at once, into the cache on disk, so that verification and timing find them
// there. NVRTC takes seconds a program and one core.
#pragma once

#include <vector>

#include "harness/render/renderer.h"

namespace pt {

struct CompileTask {
    const Scene* scene = nullptr;
    Variant variant;
};

// On CUDA; what variants have in common is compiled once. What does not compile, or does not apply, is left to whoever
// needs it: it fails there with its message. Shows progress on stderr.
void compile_ahead(const std::vector<CompileTask>& tasks);

}  // namespace pt
