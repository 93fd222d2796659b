// A thread's traversal stack in shared memory: the entries i of a block's threads lie side by side, so no two lanes use
// one bank. A kernel has one such array, however many traversals it has: no traversal runs within another.
#pragma once

#include "kernels/config.h"

namespace pt::traversal_stack {

// Bytes of a block's shared memory for traversal stacks, of the 48 KiB that a block has without asking for more. What
// else a kernel keeps in shared memory is sized by this macro.
#define PT_STACK_BYTES 32768
inline constexpr std::uint32_t most_shared_bytes = PT_STACK_BYTES;

template <class Open>
constexpr std::uint32_t shared_entries(std::uint32_t wanted) {
    constexpr std::uint32_t fit = most_shared_bytes / (kernel_config.block * static_cast<std::uint32_t>(sizeof(Open)));
    return wanted < fit ? wanted : fit;
}

template <class Open, std::uint32_t entries>
struct SharedColumn {
    PT_HD Open get(std::uint32_t i) const { return column()[i * kernel_config.block]; }
    PT_HD void set(std::uint32_t i, const Open& open) { column()[i * kernel_config.block] = open; }

private:
    __device__ static Open* column() {
        __shared__ alignas(16) unsigned char bytes[entries * kernel_config.block * sizeof(Open)];
        return reinterpret_cast<Open*>(bytes) + threadIdx.x;
    }
};

}  // namespace pt::traversal_stack
