// Switches the device that the calls of this thread go to.
#pragma once

#include "variants/cuda/runtime/check.h"

namespace pt::cuda {

inline int current_device() {
    int device = 0;
    PT_CUDA_CHECK(cudaGetDevice(&device));
    return device;
}

// Makes a CUDA device current while the object lives.
class OnDevice {
public:
    explicit OnDevice(int device) : before_(current_device()) { PT_CUDA_CHECK(cudaSetDevice(device)); }
    ~OnDevice() { (void)cudaSetDevice(before_); }
    OnDevice(const OnDevice&) = delete;
    OnDevice& operator=(const OnDevice&) = delete;

private:
    int before_;
};

}  // namespace pt::cuda
