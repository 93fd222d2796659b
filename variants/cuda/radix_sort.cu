#include "variants/cuda/radix_sort.h"

#include <algorithm>
#include <bit>

#include <cub/device/device_radix_sort.cuh>

#include "variants/cuda/queue_kernels.h"

namespace pt::cuda {
namespace {

constexpr int all_bits = 32;

using Words = cub::DoubleBuffer<std::uint32_t>;

// CUB's policy for 32-bit keys sorts 8 bits a pass in tiles of 8832 pairs: 80 blocks for the paths of an 800x800 image,
// each waiting for the one before it to publish 256 counts. Keys of few bits, which most scenes need, want small tiles
// and 32 counts. (The policy is a template argument of CUB's dispatch layer, whose names are those of CCCL 3.)
#if defined(CCCL_MAJOR_VERSION) && CCCL_MAJOR_VERSION >= 3
constexpr int few_bits = 5;  // bits of a radix digit: a warp ranks at least 32 digits

struct FewBitsHub {
    using Standard = cub::detail::radix::policy_hub<std::uint32_t, std::uint32_t, std::uint32_t>;

    using Sizes = cub::detail::radix::sm90_small_key_tuning<4, 4, 4>;

    struct Policy : cub::ChainedPolicy<500, Policy, Policy>, Standard::OnesweepSmallKeyTunedPolicy<Sizes> {
        static constexpr int ONESWEEP_RADIX_BITS = few_bits;
        using HistogramPolicy = cub::AgentRadixSortHistogramPolicy<256, 8, 1, std::uint32_t, few_bits>;
        using ExclusiveSumPolicy = cub::AgentRadixSortExclusiveSumPolicy<256, few_bits>;
        using OnesweepPolicy =
            cub::AgentRadixSortOnesweepPolicy<256, 8, std::uint32_t, 1, cub::RADIX_RANK_MATCH_EARLY_COUNTS_ANY,
                                              cub::BLOCK_SCAN_RAKING_MEMOIZE, cub::RADIX_SORT_STORE_DIRECT, few_bits>;
    };
    using MaxPolicy = Policy;
};

cudaError_t sort_few_bits(void* memory, std::size_t& bytes, Words& keys, Words& values, std::uint32_t count, int bits,
                          cudaStream_t stream) {
    using Dispatch = cub::DispatchRadixSort<cub::SortOrder::Ascending, std::uint32_t, std::uint32_t, std::uint32_t,
                                            cub::detail::identity_decomposer_t, FewBitsHub>;
    return Dispatch::Dispatch(memory, bytes, keys, values, count, 0, bits, true, stream);
}
#else
constexpr int few_bits = 0;

cudaError_t sort_few_bits(void*, std::size_t&, Words&, Words&, std::uint32_t, int, cudaStream_t) {
    return cudaErrorNotSupported;
}
#endif

cudaError_t sort_bits(void* memory, std::size_t& bytes, Words& keys, Words& values, std::uint32_t count, int bits,
                      cudaStream_t stream) {
    return bits <= few_bits ? sort_few_bits(memory, bytes, keys, values, count, bits, stream)
                            : cub::DeviceRadixSort::SortPairs(memory, bytes, keys, values, count, 0, bits, stream);
}

}  // namespace

// Reserves CUB's storage for two sorts: by all bits of a key, with most passes and storage, and by few bits.
void RadixSort::reserve(Arena& arena, const Queue& queue) {
    storage_.reserve(arena, [&](void* memory, std::size_t& bytes) {
        Words keys, slots;
        std::size_t for_few_bits = 0;
        cudaError_t error = sort_bits(memory, bytes, keys, slots, queue.capacity, all_bits, cell_.stream);
        if (error == cudaSuccess && few_bits > 0) {
            error = sort_bits(memory, for_few_bits, keys, slots, queue.capacity, few_bits, cell_.stream);
        }
        bytes = std::max(bytes, for_few_bits);
        return error;
    });
}

void RadixSort::sort(Queue& queue, std::uint32_t key_count) {
    if (queue.bound == 0) {
        return;
    }
    if (!queue.indirect) {
        write_identity(queue.order, queue.bound, cell_.stream);
        *cell_.launches += 1;
        queue.indirect = true;
    }
    const int bits = key_bits_ == KeyBits::all ? all_bits : std::bit_width(key_count - 1);
    if (bits == 0) {  // all paths have one sort key, so the order stays
        return;
    }
    Words keys(queue.keys, queue.keys_spare), slots(queue.order, queue.order_spare);
    storage_.run([&](void* memory, std::size_t& bytes) {
        return sort_bits(memory, bytes, keys, slots, queue.bound, bits, cell_.stream);
    });
    *cell_.launches += 1;
    if (slots.Current() != queue.order) {
        queue.swap_order();
    }
}

}  // namespace pt::cuda
