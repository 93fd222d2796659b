// What this GPU can do at most, measured: how many instructions it issues a second, by pipe, and how fast it copies
// memory. Kernels are told how far below they stay.
#pragma once

namespace pt::cuda {

struct Ceilings {
    // Rates of warp instructions a second, of the whole GPU.
    double issue = 0;   // multiply-adds and logic in turn: the two pipes together
    double fma = 0;     // multiply-adds alone
    double alu = 0;     // logic alone
    double xu = 0;      // powers of two alone
    double memory = 0;  // bytes read and written a second, of a copy that does not fit into the cache
};

// Takes some milliseconds and half a GiB of memory for a moment. Precondition: there is a device.
Ceilings measure_ceilings();

}  // namespace pt::cuda
