// Bound on the keys of a counting sort on the device. Shared by host and NVRTC.
#pragma once

#include <cstdint>

namespace pt::cuda {

// The most keys that one block counts: a counter each in 16 KiB of shared memory.
inline constexpr std::uint32_t most_bucket_keys = 4096;

}  // namespace pt::cuda
