// The parameters of the bucket sort's kernels, for both sides.
#pragma once

#include <cstdint>

namespace pt::cuda {

inline constexpr std::uint32_t most_bucket_keys = 4096;  // 16 KiB of shared memory

struct CountKeysParameters {
    static constexpr const char* kernel = "count_keys";
    const std::uint32_t* keys;
    std::uint32_t bound;
    std::uint32_t key_count;
    std::uint32_t* totals;
};

// Parameters of the kernel that scans the totals of the keys, in one block: totals become where each bucket starts.
struct ScanKeysParameters {
    static constexpr const char* kernel = "scan_keys";
    std::uint32_t* totals;
    std::uint32_t key_count;
};

struct ScatterParameters {
    static constexpr const char* kernel = "scatter";
    const std::uint32_t* keys;
    const std::uint32_t* order;  // null: slot i at position i
    std::uint32_t bound;
    std::uint32_t key_count;
    std::uint32_t* next;
    std::uint32_t* sorted;
};

}  // namespace pt::cuda
