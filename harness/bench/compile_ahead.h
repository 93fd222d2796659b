// Compiles the CUDA kernels of many variants in parallel into the kernel cache on disk, where verification and timing
// find them. NVRTC takes seconds for each program and uses one core.
#pragma once

#include <string>
#include <vector>

#include "harness/cuda/backend.h"

namespace pt {

struct CompileTask {
    const Scene* scene = nullptr;
    Variant variant;
    std::string architecture = {};  // GPU architecture, "sm_90" for instance; empty: that of the installed GPU
    // Whether to compile the variant's own programs only, not those of variants that verification compares it with.
    bool is_alone = false;
};

// CUDA programs that compiled and that did not, and the CPU time that all the compilations took.
struct CompiledPrograms {
    std::size_t compiled = 0;               // their number
    std::vector<std::string> refused = {};  // keys of programs that did not compile or could not be kept in the cache
    double cpu_seconds = 0;
};

// Compiles the programs of CUDA variants into the kernel cache on disk; a program that several variants share is
// compiled once. A variant that does not compile or does not apply is skipped, and reports its error when it is used.
// Shows progress on stderr.
CompiledPrograms compile_ahead(const std::vector<CompileTask>& tasks);

// Compiles CUDA programs in parallel, the slowest first, without a GPU or its driver. Does nothing for a single program
// or on a single processor, where nothing would run in parallel.
CompiledPrograms compile_programs(const cuda::ProgramsToCompile& programs);

// Compiles the programs of `--compile`, on a machine that may have no GPU, and prints their number, the cache folder
// and the CPU time. Throws InputError for an unknown architecture, MachineError if a program does not compile.
void compile_for(const std::string& architecture, std::vector<CompileTask> tasks);

}  // namespace pt
