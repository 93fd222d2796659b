// The GPU that the CUDA backend runs on: the first one. Where several render together, the others are like it.
#pragma once

#include <string>

namespace pt::cuda {

struct Device {
    std::string name;
    int major = 0, minor = 0;  // compute capability of the GPU
    int multiprocessors = 0;
    int clock_khz = 0, memory_clock_khz = 0, memory_bus_bits = 0;
    int l2_bytes = 0;
    bool ecc = false;
    bool mps = false;  // several processes run on the GPU at once, by NVIDIA's multi-process service, not by turns
    std::size_t memory_bytes = 0;
    int driver_version = 0, runtime_version = 0;  // versions as CUDA writes them in numbers: 13000 is 13.0
    std::string architecture() const { return "sm_" + std::to_string(major) + std::to_string(minor); }
};

// Why no device can be used (no driver, no device); empty: one can.
std::string device_missing();

// The device that the backend uses. Precondition: device_missing() is empty.
const Device& device();

// Number of devices, from the first on, that are like the first. Precondition: device_missing() is empty.
int equal_devices();

// The text of a version as CUDA numbers it: "13.0" for 13000.
std::string version_text(int version);

}  // namespace pt::cuda
