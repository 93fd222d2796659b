// Measures what this machine's CPU can do at most, for a passport: rates that say how machines differ.
#pragma once

#include <cstdint>
#include <vector>

namespace pt {

// The rate at which all threads together copy, each a block of its own memory over and over. A block that a cache holds
// is copied faster.
struct CopyRate {
    std::uint64_t bytes_per_thread = 0;  // size of a thread's block
    double gb_per_s = 0;                 // 10^9 bytes read and written per second by all threads

    template <class Self, class Visit>
    static void fields(Self& self, const Visit& visit) {
        visit("bytes_per_thread", self.bytes_per_thread);
        visit("gb_per_s", self.gb_per_s);
    }
};

struct ChipRates {
    std::uint64_t threads = 0;     // OpenMP threads, all of which take part
    std::vector<CopyRate> copies;  // by increasing block size
    double gflops = 0;             // 10^9 multiplications and additions per second in single precision, not fused
    double atomics_per_s = 0;      // atomic additions per second to one counter that all threads share
    double fork_join_us = 0;       // median time of a parallel region with an empty body, in microseconds

    template <class Self, class Visit>
    static void fields(Self& self, const Visit& visit) {
        visit("threads", self.threads);
        visit("copies", self.copies);
        visit("gflops", self.gflops);
        visit("atomics_per_s", self.atomics_per_s);
        visit("fork_join_us", self.fork_join_us);
    }
};

// Measures the rates in about a second, with at most half a GiB of memory.
ChipRates measure_chip_rates();

}  // namespace pt
