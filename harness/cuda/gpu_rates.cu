#include "harness/cuda/gpu_rates.h"

#include <chrono>

#include "harness/cuda/probe.h"

namespace pt::cuda {

namespace {

constexpr unsigned threads = 256;
constexpr std::size_t smallest_copy = std::size_t{1} << 20, largest_copy = std::size_t{512} << 20;

unsigned full_grid() {
    cudaDeviceProp properties{};
    PT_CUDA_CHECK(cudaGetDeviceProperties(&properties, 0));
    return static_cast<unsigned>(properties.multiProcessorCount) *
           static_cast<unsigned>(properties.maxThreadsPerMultiProcessor / static_cast<int>(threads));
}

// Copies a block of memory `rounds` times. Loads and stores pass by the L1 cache, so that each round asks the L2 cache.
__global__ void __launch_bounds__(threads) copy_often(const uint4* from, uint4* to, std::size_t pieces, int rounds) {
    for (int round = 0; round < rounds; ++round) {
        for (std::size_t i = std::size_t{blockIdx.x} * threads + threadIdx.x; i < pieces;
             i += std::size_t{gridDim.x} * threads) {
            __stcg(to + i, __ldcg(from + i));
        }
    }
}

__global__ void __launch_bounds__(threads) add_often(unsigned* counter, int rounds) {
    for (int round = 0; round < rounds; ++round) {
        if (threadIdx.x % 32 == 0) {
            atomicAdd(counter, 1u);
        }
    }
}

__global__ void do_nothing() {}

double atomics_per_second(const Timer& timer, unsigned blocks) {
    constexpr int rounds = 64;
    const Memory counter(sizeof(unsigned));
    const double seconds = timer.fastest([&] { add_often<<<blocks, threads>>>(counter.as<unsigned>(), rounds); });
    return double(rounds) * blocks * (threads / 32) / seconds;
}

double launch_microseconds(const Timer& timer) {
    constexpr int launches = 256;
    return 1e6 / launches * timer.fastest([] {
        for (int i = 0; i < launches; ++i) {
            do_nothing<<<1, 32>>>();
        }
    });
}

double host_wait_microseconds() {
    std::vector<double> microseconds(101);
    for (double& of_one : microseconds) {
        const auto start = std::chrono::steady_clock::now();
        do_nothing<<<1, 32>>>();
        PT_CUDA_CHECK(cudaDeviceSynchronize());
        of_one = std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count();
    }
    const auto middle = microseconds.begin() + static_cast<std::ptrdiff_t>(microseconds.size() / 2);
    std::nth_element(microseconds.begin(), middle, microseconds.end());
    return *middle;
}

// The largest of the sizes of copies that half of the memory which is free now holds.
std::size_t largest_copy_that_fits() {
    std::size_t free = 0, total = 0;
    PT_CUDA_CHECK(cudaMemGetInfo(&free, &total));
    std::size_t bytes = largest_copy;
    while (bytes > smallest_copy && bytes > free / 2) {
        bytes /= 2;
    }
    return bytes;
}

}  // namespace

std::vector<GpuCopyRate> measure_copy_rates() {
    const unsigned blocks = full_grid();
    const std::size_t largest = largest_copy_that_fits();
    const Timer timer;
    const Memory from(largest / 2), to(largest / 2);
    PT_CUDA_CHECK(cudaMemset(from.as<void>(), 0, largest / 2));
    std::vector<GpuCopyRate> rates;
    for (std::size_t bytes = smallest_copy; bytes <= largest; bytes *= 2) {
        // As many rounds as make a launch long enough for what precedes its first load not to count.
        const int rounds = static_cast<int>(largest_copy / bytes < 4 ? 4 : largest_copy / bytes);
        const double seconds = timer.fastest([&] {
            copy_often<<<blocks, threads>>>(from.as<uint4>(), to.as<uint4>(), bytes / 2 / sizeof(uint4), rounds);
        });
        rates.push_back({static_cast<double>(bytes), 1e-9 * static_cast<double>(bytes) * rounds / seconds});
    }
    return rates;
}

const std::vector<GpuCopyRate>& copy_rates() {
    static const std::vector<GpuCopyRate> rates = measure_copy_rates();
    return rates;
}

GpuRates measure_gpu_rates() {
    const unsigned blocks = full_grid();
    const Timer timer;
    return {.copies = measure_copy_rates(),
            .atomics_per_s = atomics_per_second(timer, blocks),
            .launch_us = launch_microseconds(timer),
            .host_wait_us = host_wait_microseconds()};
}

}  // namespace pt::cuda
