// The compiler's report on a program's kernels: registers, spills, shared memory. It needs compilation alone, and so
// covers GPUs that the machine does not have.
#pragma once

#include <string>
#include <vector>

#include "variants/cuda/runtime/module.h"

namespace pt::cuda {

struct KernelReport {
    std::string name;
    int registers = 0;                                                 // registers of the kernel per thread
    int stack_bytes = 0, spill_store_bytes = 0, spill_load_bytes = 0;  // stack and spills of the kernel per thread
    int shared_bytes = 0;                                              // shared memory of the kernel per block
};

struct CompilerReport {
    std::string cubin;
    std::vector<KernelReport> kernels;
    double compile_seconds = 0;
    std::vector<std::string> options;
};

// Compiles a module without the cache and reports on its kernels. Throws as compile_module does.
CompilerReport compiler_report(const ModuleRequest& request);

// Parses what ptxas logs with --ptxas-options=-v.
std::vector<KernelReport> parse_ptxas_log(const std::string& log);

}  // namespace pt::cuda
