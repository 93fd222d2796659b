// What the Thrust compactions and sorts share: where a call's temporaries come from, how it waits for the device, and
// how it is counted.
#pragma once

#include <map>
#include <utility>

#include <thrust/system/cuda/execution_policy.h>

#include "variants/cuda/stages.h"
#include "variants/descriptor.h"

namespace pt::cuda {

inline constexpr Tunable thrust_tunables[] = {
    {.name = "caching_allocator",
     .default_value = 0,
     .lowest = 0,
     .highest = 1,
     .summary = "1: blocks for Thrust's temporaries are kept and used again; 0: cudaMalloc and cudaFree for each"},
    {.name = "par_nosync",
     .default_value = 0,
     .lowest = 0,
     .highest = 1,
     .summary = "1: thrust::cuda::par_nosync, which waits for the device only where a result needs it"},
};

// The descriptor of a Thrust compaction on CUDA, made from the one on the CPU: the host waits for its count.
inline Descriptor on_device(Descriptor descriptor,
                            Reason (*unsupported_reason)(FeatureSet, const VariantTraits&) = nullptr) {
    CompactionTraits traits = traits_in<CompactionTraits>(descriptor);
    traits.host_sync = true;
    descriptor.traits = traits;
    descriptor.backends = on_cuda;
    descriptor.tunables = thrust_tunables;
    descriptor.unsupported_reason = unsupported_reason;
    return descriptor;
}

// The allocator that Thrust takes temporaries from. One type either keeps blocks or frees them, so that each algorithm
// is compiled once.
class TemporaryMemory {
public:
    using value_type = char;

    explicit TemporaryMemory(bool keeps_blocks) : keeps_blocks_(keeps_blocks) {}
    ~TemporaryMemory() {
        for (const auto& [bytes, block] : free_) {
            (void)cudaFree(block);
        }
    }
    TemporaryMemory(const TemporaryMemory&) = delete;
    TemporaryMemory& operator=(const TemporaryMemory&) = delete;

    // Allocates, or, with keeps_blocks, reuses the smallest free block that is large enough: its last use and the next
    // are on one stream, so they do not overlap. Throws OutOfMemory.
    char* allocate(std::ptrdiff_t count) {
        const auto bytes = static_cast<std::size_t>(count);
        if (const auto block = free_.lower_bound(bytes); block != free_.end()) {
            char* const memory = block->second;
            used_.insert({memory, block->first});
            free_.erase(block);
            return memory;
        }
        void* memory = nullptr;
        const cudaError_t error = cudaMalloc(&memory, bytes);
        if (error == cudaErrorMemoryAllocation) {
            (void)cudaGetLastError();
            std::size_t free_bytes = 0, total_bytes = 0;
            (void)cudaMemGetInfo(&free_bytes, &total_bytes);
            throw OutOfMemory(bytes, free_bytes);
        }
        PT_CUDA_CHECK(error);
        if (keeps_blocks_) {
            used_.insert({static_cast<char*>(memory), bytes});
        }
        return static_cast<char*>(memory);
    }
    // Frees a block; called from destructors, so it does not throw.
    void deallocate(char* memory, std::size_t) noexcept {
        if (keeps_blocks_) {
            free_.insert({used_.at(memory), memory});
            used_.erase(memory);
        } else {
            (void)cudaFree(memory);
        }
    }

private:
    bool keeps_blocks_;
    std::multimap<std::size_t, char*> free_;  // free blocks of device memory by size; empty unless keeps_blocks_
    std::map<char*, std::size_t> used_;
};

// Calls Thrust on a cell's stream in the way that the tunables ask for.
class ThrustCalls {
public:
    explicit ThrustCalls(const CellContext& cell)
        : stream_(cell.stream),
          launches_(cell.launches),
          host_waits_(cell.host_waits),
          caches_(cell.tunable("caching_allocator") != 0),
          nosync_(cell.tunable("par_nosync") != 0),
          memory_(caches_) {}

    // Calls Thrust by call(policy) where the algorithm returns a count, for which Thrust waits under either policy.
    // Counts as one launch.
    template <class Call>
    auto for_count(Call&& call) {
        *launches_ += 1;
        *host_waits_ += 1;
        return with_policy(call);
    }
    // Calls Thrust by call(policy), which returns nothing: the host waits in thrust::par or in cudaFree of temporaries.
    template <class Call>
    void for_effect(Call&& call) {
        *launches_ += 1;
        *host_waits_ += nosync_ && caches_ ? 0 : 1;
        with_policy(call);
    }

private:
    template <class Call>
    auto with_policy(Call& call) {
        return nosync_ ? call(thrust::cuda::par_nosync(memory_).on(stream_))
                       : call(thrust::cuda::par(memory_).on(stream_));
    }

    cudaStream_t stream_;
    std::uint64_t* launches_;
    std::uint64_t* host_waits_;
    bool caches_, nosync_;
    TemporaryMemory memory_;
};

}  // namespace pt::cuda
