// Measures the peak rates of this GPU: instructions issued per second, by pipe, and bytes copied per second. The rates
// of kernels are reported relative to these ceilings.
#pragma once

namespace pt::cuda {

struct Ceilings {
    // Rates of the whole GPU, in warp instructions per second.
    double issue = 0;   // multiply-adds and logic in turn, which use two pipes
    double fma = 0;     // multiply-adds only
    double alu = 0;     // logic only
    double xu = 0;      // powers of two only
    double memory = 0;  // bytes read and written per second by a copy too large for the cache
};

// Measures the ceilings in some milliseconds, with half a GiB of device memory. Precondition: there is a device.
Ceilings measure_ceilings();

}  // namespace pt::cuda
