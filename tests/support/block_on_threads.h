// The words of CUDA that a kernel is made of, for a kernel that runs on the host: a block is a thread of the operating
// system a lane, shared memory is static memory, and the lanes of a warp meet at a barrier wherever they exchange
// something. Slow, and without a GPU's ways of going wrong, but every race between two lanes is one between two
// threads, which a thread sanitizer finds. Before the kernel's text a program says what NVRTC's would (program_text in
// variants/cuda/runtime/module.cpp).
#pragma once

#include <atomic>
#include <barrier>
#include <bit>
#include <cstdint>
#include <memory>
#include <thread>
#include <vector>

#include <vector_types.h>

#undef __device__
#undef __global__
#undef __shared__
#undef __launch_bounds__
#define __device__
#define __global__
#define __shared__ static
#define __launch_bounds__(...)

namespace pt::test {

// Stands for host_bytes::KERNEL, the size of the parameters that the host launches a kernel with: in a test host and
// device are one program, and have them from one struct.
struct SameProgram {
    friend constexpr bool operator==(std::size_t, SameProgram) { return true; }
};

struct Place {
    unsigned x;
};

// What the lanes of a warp lay open to each other.
struct HostWarp {
    std::barrier<> meeting{32};
    std::uint64_t values[32] = {};
};

struct HostBlock {
    explicit HostBlock(std::uint32_t threads) : meeting(threads), warps(threads / 32) {}
    std::barrier<> meeting;
    std::vector<HostWarp> warps;
    std::atomic<int> votes = 0;
};

inline thread_local HostBlock* host_block = nullptr;
inline thread_local unsigned host_thread = 0;

inline HostWarp& host_warp() { return host_block->warps[host_thread / 32]; }

// Every lane's value, laid open: visit(values) while all are there.
template <class Visit>
auto with_values_of_warp(std::uint64_t value, const Visit& visit) {
    HostWarp& warp = host_warp();
    warp.values[host_thread % 32] = value;
    warp.meeting.arrive_and_wait();
    const auto result = visit(warp.values);
    warp.meeting.arrive_and_wait();
    return result;
}

}  // namespace pt::test

inline thread_local pt::test::Place threadIdx{0}, blockIdx{0};
inline pt::test::Place blockDim{0}, gridDim{0};

inline void __syncwarp() { pt::test::host_warp().meeting.arrive_and_wait(); }
inline void __syncthreads() { pt::test::host_block->meeting.arrive_and_wait(); }
inline int __syncthreads_count(int vote) {
    pt::test::host_block->votes += vote;
    __syncthreads();
    const int votes = pt::test::host_block->votes;
    __syncthreads();
    pt::test::host_block->votes -= vote;
    __syncthreads();
    return votes;
}
inline unsigned __ballot_sync(unsigned, bool vote) {
    return pt::test::with_values_of_warp(vote ? 1u : 0u, [](const std::uint64_t* values) {
        unsigned votes = 0;
        for (unsigned lane = 0; lane < 32; ++lane) {
            votes |= static_cast<unsigned>(values[lane]) << lane;
        }
        return votes;
    });
}
inline bool __any_sync(unsigned mask, bool vote) { return __ballot_sync(mask, vote) != 0; }
inline unsigned __match_any_sync(unsigned, std::uint32_t value) {
    return pt::test::with_values_of_warp(value, [&](const std::uint64_t* values) {
        unsigned equal = 0;
        for (unsigned lane = 0; lane < 32; ++lane) {
            equal |= (values[lane] == value ? 1u : 0u) << lane;
        }
        return equal;
    });
}
template <class T>
T __shfl_sync(unsigned, T value, unsigned lane) {
    return pt::test::with_values_of_warp(value,
                                         [&](const std::uint64_t* values) { return static_cast<T>(values[lane]); });
}
// A lane that has none so far below it keeps its own.
template <class T>
T __shfl_up_sync(unsigned mask, T value, unsigned distance) {
    const unsigned lane = pt::test::host_thread % 32;
    return __shfl_sync(mask, value, lane >= distance ? lane - distance : lane);
}
template <class T>
T __shfl_xor_sync(unsigned mask, T value, unsigned distance) {
    return __shfl_sync(mask, value, (pt::test::host_thread % 32) ^ distance);
}
inline int __ffs(int bits) { return bits == 0 ? 0 : std::countr_zero(static_cast<unsigned>(bits)) + 1; }
inline int __popc(unsigned bits) { return std::popcount(bits); }
inline void __nanosleep(unsigned) { std::this_thread::yield(); }
// The atomic operations beside it have its order here.
inline void __threadfence_block() {}
inline void __threadfence() {}
inline std::uint32_t atomicCAS(std::uint32_t* address, std::uint32_t expected, std::uint32_t value) {
    std::atomic_ref<std::uint32_t>(*address).compare_exchange_strong(expected, value, std::memory_order_acq_rel);
    return expected;
}
inline std::uint32_t atomicExch(std::uint32_t* address, std::uint32_t value) {
    return std::atomic_ref<std::uint32_t>(*address).exchange(value, std::memory_order_acq_rel);
}
template <class T>
T atomicAdd(T* address, T value) {
    return std::atomic_ref<T>(*address).fetch_add(value, std::memory_order_relaxed);
}
inline std::uint32_t __float_as_uint(float value) { return std::bit_cast<std::uint32_t>(value); }
inline float __uint_as_float(std::uint32_t value) { return std::bit_cast<float>(value); }
inline int __double2loint(double value) { return static_cast<int>(std::bit_cast<std::uint64_t>(value)); }
inline int __double2hiint(double value) { return static_cast<int>(std::bit_cast<std::uint64_t>(value) >> 32); }
inline double __hiloint2double(int high, int low) {
    return std::bit_cast<double>(static_cast<std::uint64_t>(static_cast<std::uint32_t>(high)) << 32 |
                                 static_cast<std::uint32_t>(low));
}

namespace pt::test {

// Runs the kernel, block after block; kernel() is called by each thread of each.
template <class Kernel>
void run_blocks(std::uint32_t blocks, std::uint32_t threads_a_block, const Kernel& kernel) {
    gridDim.x = blocks;
    blockDim.x = threads_a_block;
    for (std::uint32_t number = 0; number < blocks; ++number) {
        HostBlock block(threads_a_block);
        std::vector<std::thread> threads;
        for (std::uint32_t thread = 0; thread < threads_a_block; ++thread) {
            threads.emplace_back([&, thread] {
                host_block = &block;
                host_thread = threadIdx.x = thread;
                blockIdx.x = number;
                kernel();
            });
        }
        for (std::thread& thread : threads) {
            thread.join();
        }
    }
}

}  // namespace pt::test
