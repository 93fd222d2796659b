// Device predicates for whether a slot is in play and alive, by slot or by position, in any layout: compactions of slot
// numbers select by them. The count is read on the device, so that the host need not know it.
#pragma once

#include <thrust/iterator/counting_iterator.h>
#include <thrust/iterator/transform_iterator.h>

#include "variants/cuda/device/path_store.h"
#include "variants/cuda/stages.h"

namespace pt::cuda {

inline constexpr std::uint32_t no_slot = 0xffffffffu;

// The slot at a position of a queue; no_slot for positions from the count on, where the index order holds old slots.
struct SlotAt {
    const std::uint32_t* order = nullptr;  // slots of paths by queue position; null: slot i is at position i
    const std::uint32_t* count = nullptr;  // number of paths in play, in device memory

    PT_HD std::uint32_t operator()(std::uint32_t position) const {
        if (position >= *count) {
            return no_slot;
        }
        return order == nullptr ? position : order[position];
    }
};

struct IsAlive {
    FieldView segment;

    PT_HD bool operator()(std::uint32_t slot) const {
        return slot != no_slot && value_at(segment, slot) != Path<float>::ended;
    }
};

struct IsAliveAt {
    SlotAt slot_at;
    IsAlive is_alive;

    PT_HD bool operator()(std::uint32_t position) const { return is_alive(slot_at(position)); }
};

inline SlotAt slot_at(const Queue& queue) { return {queue.indirect ? queue.order : nullptr, queue.count}; }
inline IsAlive is_alive(const Queue& queue, const CellContext& cell) {
    return {cell.layout->segment(queue.paths, cell.real_bytes)};
}

// An iterator over function(0), function(1), and so on.
template <class Function>
auto by_position(const Function& function) {
    return thrust::make_transform_iterator(thrust::counting_iterator<std::uint32_t>(0), function);
}

}  // namespace pt::cuda
