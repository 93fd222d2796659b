// NVRTC, loaded at run time: a program that never compiles a kernel needs no CUDA toolkit to start.
#pragma once

#include <string>
#include <vector>

namespace pt::cuda {

struct Compilation {
    bool succeeded = false;
    std::string cubin;
    std::string log;
    double seconds = 0;
};

// Why NVRTC or the CUDA headers cannot be had; empty: they can.
std::string nvrtc_missing();

// NVRTC's version, as "13.0"; empty if NVRTC is missing.
std::string nvrtc_version();

// The include options for the CUDA toolkit's headers; empty if these are missing.
std::vector<std::string> toolkit_include_options();

// Compiles one translation unit for one architecture ("sm_90"). Throws std::runtime_error if NVRTC is missing.
Compilation compile(const std::string& source, const std::string& name, const std::vector<std::string>& options);

}  // namespace pt::cuda
