#include "variants/cuda/radix_sort.h"

#include <bit>

#include <cub/device/device_radix_sort.cuh>

#include "variants/cuda/queue_kernels.h"

namespace pt::cuda {
namespace {

constexpr int all_bits = 32;

using Words = cub::DoubleBuffer<std::uint32_t>;

}  // namespace

// With all bits there are most passes, and so the most storage.
void RadixSort::reserve(Arena& arena, const Queue& queue) {
    storage_.reserve(arena, [&](void* memory, std::size_t& bytes) {
        Words keys, slots;
        return cub::DeviceRadixSort::SortPairs(memory, bytes, keys, slots, queue.capacity, 0, all_bits, cell_.stream);
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
    if (bits == 0) {  // one key: the order is that already
        return;
    }
    Words keys(queue.keys, queue.keys_spare), slots(queue.order, queue.order_spare);
    storage_.run([&](void* memory, std::size_t& bytes) {
        return cub::DeviceRadixSort::SortPairs(memory, bytes, keys, slots, queue.bound, 0, bits, cell_.stream);
    });
    *cell_.launches += 1;
    if (slots.Current() != queue.order) {
        queue.swap_order();
    }
}

}  // namespace pt::cuda
