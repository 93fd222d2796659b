// Measures the peak rates of this machine's processor and memory for a passport (`ptbench passport`), to explain why
// machines differ in render times.
#pragma once

#include <cstdint>
#include <vector>

namespace pt {

// A copy of `bytes` bytes, split among all threads, again and again: what stays in a cache is faster.
struct CopyRate {
    std::uint64_t bytes = 0;
    double gb_per_s = 0;  // rate of the copy, in 10^9 bytes read and written per second

    template <class Self, class Visit>
    static void fields(Self& self, const Visit& visit) {
        visit("bytes", self.bytes);
        visit("gb_per_s", self.gb_per_s);
    }
};

struct ChipRates {
    std::uint64_t threads = 0;     // number of OpenMP threads, all of which are used
    std::vector<CopyRate> copies;  // copy rates by increasing number of bytes
    double gflops = 0;             // 10^9 multiplications and additions per second in single precision, not fused
    double atomics_per_s = 0;      // atomic additions per second to one counter that all threads share
    double fork_join_us = 0;       // median time of a parallel loop with an empty body, in microseconds

    template <class Self, class Visit>
    static void fields(Self& self, const Visit& visit) {
        visit("threads", self.threads);
        visit("copies", self.copies);
        visit("gflops", self.gflops);
        visit("atomics_per_s", self.atomics_per_s);
        visit("fork_join_us", self.fork_join_us);
    }
};

// Measures the rates in about a second, with half a GiB of memory.
ChipRates measure_chip_rates();

}  // namespace pt
