// Compiles the kernels of many variants at once, into the cache on disk, so that verification and timing find them
// there. NVRTC takes seconds a program and one core.
#pragma once

#include <string>
#include <vector>

#include "harness/cuda/backend.h"

namespace pt {

struct CompileTask {
    const Scene* scene = nullptr;
    Variant variant;
    std::string architecture = {};  // "sm_90"; empty: the device's
    // Whether the variants that its claim is held to, the exact twin and the reference, are left out.
    bool is_alone = false;
};

// What became of the programs that were asked for.
struct CompiledPrograms {
    std::size_t compiled = 0;
    std::size_t refused = 0;  // did not compile, or could not be kept
    double cpu_seconds = 0;
};

// Compiles the programs of CUDA variants into the cache on disk; what variants have in common is compiled once. A
// variant that does not compile or does not apply is skipped: it fails, with its message, when it is used. Shows
// progress on stderr.
CompiledPrograms compile_ahead(const std::vector<CompileTask>& tasks);

// Compiles programs given by name, those first that take longest. Needs neither a device nor a driver. Does nothing for
// a single program or on a single processor, where nothing would run at once.
CompiledPrograms compile_programs(const cuda::ProgramsToCompile& programs);

// Compiles for `--compile`, on a machine that may have no GPU, and prints how many programs, where they lie, and what
// they took. Throws InputError for an architecture that does not exist, MachineError where a program is refused.
void compile_for(const std::string& architecture, std::vector<CompileTask> tasks);

}  // namespace pt
