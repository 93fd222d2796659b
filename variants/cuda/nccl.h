// NCCL, loaded at run time as NVRTC is: a program that renders on one GPU needs none, a build needs neither its header
// nor its library, and a package takes the one of the machine (CUDA's, or PyTorch's).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "variants/cuda/check.h"

namespace pt::cuda {

// Why NCCL cannot be had; empty: it can.
std::string nccl_missing();
// "2.28.3"; empty where it is missing.
std::string nccl_version();

// One of several devices, with what it adds.
struct Addend {
    int device = 0;
    cudaStream_t stream = nullptr;
    const std::int64_t* values = nullptr;
};

// Enqueues the sum of all devices' values into memory of the first one, on the streams. The devices are 0, 1, .. The
// first call for a number of devices connects them, which takes seconds.
void add_to_first(const std::vector<Addend>& addends, std::int64_t* sum, std::size_t count);

}  // namespace pt::cuda
