// Compiles the kernels of many variants at once, into the cache on disk, so that verification and timing find them
// there. NVRTC takes seconds a program and one core.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "harness/render/renderer.h"

namespace pt {

struct CompileTask {
    const Scene* scene = nullptr;
    Variant variant;
    std::string architecture = {};  // "sm_90"; empty: the device's
};

// On CUDA; what variants have in common is compiled once. A variant that does not compile or does not apply is skipped:
// it fails, with its message, when it is used. Shows progress on stderr.
void compile_ahead(const std::vector<CompileTask>& tasks);

// The same for programs by name; each call compiles its program and puts it into the cache. Needs neither a device nor
// a driver. Does nothing for a single program or on a single processor, where nothing would run at once.
void compile_programs(const std::map<std::string, std::function<void()>>& programs);

}  // namespace pt
