// NCCL, loaded at run time as NVRTC is: a program that renders on one GPU needs none, a build needs neither its header
// nor its library, and a package takes the one of the machine (CUDA's, or PyTorch's).
#pragma once

#include <cstdint>
#include <string>

#include "variants/cuda/check.h"

namespace pt::cuda {

// Why NCCL cannot be had; empty: it can.
std::string nccl_missing();
// "2.28.3"; empty where it is missing.
std::string nccl_version();

// Connects the devices 0, 1, .. `devices` - 1, which takes seconds at the first call for a number of them. From one
// thread, before `add_to_first`.
void connect_devices(std::size_t devices);

// One of several devices that are connected, with what it adds.
struct Addend {
    std::size_t device = 0, devices = 0;
    cudaStream_t stream = nullptr;
    const std::int64_t* values = nullptr;
};

// Enqueues this device's part in the sum of all devices' values, into `sum` in memory of the first one; of the others
// nobody reads it. The stream goes on when the device has done its part, and so does a thread: each device's part is
// enqueued by its own thread, or two calls in a row from one may wait for each other for ever.
void add_to_first(const Addend& addend, std::int64_t* sum, std::size_t count);

// Ends all sums that were enqueued, whether or not every device takes part, and the connections with them: without it,
// devices wait for one that has failed. From one thread, while no other is in `add_to_first`.
void disconnect_devices();

}  // namespace pt::cuda
