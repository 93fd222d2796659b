// NCCL, loaded at run time as NVRTC is: a program that renders on one GPU needs no NCCL, a build needs neither its
// header nor its library, and a package uses the machine's copy (CUDA's, or PyTorch's).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "variants/cuda/runtime/check.h"

namespace pt::cuda {

// Why NCCL cannot be had; empty: it can.
std::string nccl_missing();
// NCCL's version, as "2.28.3"; empty where NCCL is missing.
std::string nccl_version();

// One of several connected devices, with the values that it adds.
struct Addend {
    std::size_t device = 0, devices = 0;
    cudaStream_t stream = nullptr;
    const std::int64_t* values = nullptr;
};

// Connects the devices 0, 1, .., one per addend, which takes seconds the first time, and enqueues a first sum of their
// values, which loads what NCCL loads at first use. To be called from one thread, before `add_to_first`.
void connect_devices(const std::vector<Addend>& addends, std::int64_t* sum, std::size_t count);

// Enqueues this device's part in the sum of all devices' values, into `sum` in memory of the first one. The call may
// wait until every device's part is enqueued, so each device has a thread of its own. A device whose part has begun
// waits for the others: until then they must not make calls that wait for all devices, as allocations of memory may.
void add_to_first(const Addend& addend, std::int64_t* sum, std::size_t count);

// Ends all sums that were enqueued, whether or not every device takes part, and the connections: otherwise devices
// would wait for one that has failed. To be called from one thread, while no other is in `add_to_first`.
void disconnect_devices();

}  // namespace pt::cuda
