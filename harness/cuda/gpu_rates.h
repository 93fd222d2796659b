// Measures what bounds kernels on this GPU beside its arithmetic: how fast it copies memory, by the size of what is
// copied, how fast threads add to one counter, and what a launch and a wait for the device take.
#pragma once

#include <vector>

#include "harness/cuda/memory_bound.h"

namespace pt {

struct GpuRates {
    std::vector<GpuCopyRate> copies;  // by increasing size
    double atomics_per_s = 0;         // additions per second to one counter, one of each warp
    double launch_us = 0;             // time of a kernel without work among many, in microseconds
    double host_wait_us = 0;          // median time of a launch that the host waits for, in microseconds

    template <class Self, class Visit>
    static void fields(Self& self, const Visit& visit) {
        visit("copies", self.copies);
        visit("atomics_per_s", self.atomics_per_s);
        visit("launch_us", self.launch_us);
        visit("host_wait_us", self.host_wait_us);
    }
};

namespace cuda {

// Measures the rates of copies of 1 MiB to 512 MiB, by increasing size, in some milliseconds with half a GiB of device
// memory. Precondition: there is a device.
std::vector<GpuCopyRate> measure_copy_rates();
// The rates, measured at the first call in this process.
const std::vector<GpuCopyRate>& copy_rates();

// Measures the rates in some milliseconds. Precondition: there is a device.
GpuRates measure_gpu_rates();

}  // namespace cuda
}  // namespace pt
