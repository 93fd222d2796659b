// What the compiler says of a program's kernels: registers, spills, shared memory. From compilation alone, so for GPUs
// too that nobody here has.
#pragma once

#include <string>
#include <vector>

#include "variants/cuda/runtime/module.h"

namespace pt::cuda {

struct KernelReport {
    std::string name;
    int registers = 0;                                                 // a thread
    int stack_bytes = 0, spill_store_bytes = 0, spill_load_bytes = 0;  // a thread
    int shared_bytes = 0;                                              // a block
};

struct CompilerReport {
    std::string cubin;
    std::vector<KernelReport> kernels;
    double compile_seconds = 0;
    std::vector<std::string> options;
};

// Compiles, without the cache. Throws as compile_module does.
CompilerReport compiler_report(const ModuleRequest& request);

// Reads ptxas's own words (--ptxas-options=-v).
std::vector<KernelReport> parse_ptxas_log(const std::string& log);

}  // namespace pt::cuda
