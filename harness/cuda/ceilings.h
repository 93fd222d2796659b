// Measures the peak rates of this GPU: instructions issued per second, by pipe, and bytes copied per second. The rates
// of kernels are reported relative to these ceilings.
#pragma once

namespace pt::cuda {

struct Ceilings {
    // Peak rates of the whole GPU, in warp instructions per second.
    double issue = 0;   // issue rate: multiply-adds and logic in turn, on both pipes
    double fma = 0;     // execution rate of multiply-adds alone
    double alu = 0;     // execution rate of logic instructions alone
    double xu = 0;      // execution rate of powers of two (ex2) alone
    double memory = 0;  // bytes read and written per second by a copy larger than the cache
};

// Measures the ceilings in some milliseconds, with half a GiB of device memory. Precondition: there is a device.
Ceilings measure_ceilings();

}  // namespace pt::cuda
