// Parts shared by the CUB compactions. The count of paths stays on the device: CUB writes the new count beside the old,
// which the selection reads, and no host waits. CUB's number of items is the queue's bound, which does not change.
#pragma once

#include "variants/cuda/cub_storage.h"
#include "variants/cuda/live_slots.h"
#include "variants/cuda/register.h"
#include "variants/layout/payload_iterator.cuh"
#include "variants/work_checks.h"

namespace pt::cuda {

// Loads the path in a slot; for slots from the count on gives an ended path, since they hold nothing that is in play.
template <class Paths>
struct PathAt {
    Paths paths;
    const std::uint32_t* count;  // number of paths in play in the queue, in device memory

    PT_HD Path<float> operator()(std::uint32_t slot) const {
        if (slot < *count) {
            return paths.load(slot);
        }
        Path<float> ended{};
        ended.segment = Path<float>::ended;
        return ended;
    }
};

// CUB compaction of slot numbers. Algorithm::slots(memory, bytes, slot_at, is_alive, kept, count, items, stream) calls
// CUB to bring the slots of live paths, among positions 0 to items - 1, to the front of `kept`. Counts as one launch.
template <class Algorithm>
class CubIndexCompaction final : public Compaction {
public:
    bool moves_paths() const override { return false; }
    explicit CubIndexCompaction(const CellContext& cell) : cell_(cell) {}

    void reserve(Arena& arena, const Queue& queue) override {
        storage_.reserve(arena, [&](void* memory, std::size_t& bytes) {
            return Algorithm::slots(memory, bytes, SlotAt{}, IsAlive{}, nullptr, nullptr,
                                    static_cast<int>(queue.capacity), cell_.stream);
        });
    }
    void compact(Queue& queue) override {
        if (queue.bound == 0) {
            return;
        }
        storage_.run([&](void* memory, std::size_t& bytes) {
            return Algorithm::slots(memory, bytes, slot_at(queue), is_alive(queue, cell_), queue.order_spare,
                                    queue.count_spare, static_cast<int>(queue.bound), cell_.stream);
        });
        *cell_.launches += 1;
        queue.swap_order();
        queue.swap_count();
        queue.indirect = true;
    }

private:
    CellContext cell_;
    CubStorage storage_;
};

// CUB compaction of the paths themselves, where the tunable `payload` asks for it. Algorithm::paths<Paths>(memory,
// bytes, from, to, slot_at, is_alive, count, items, stream) calls CUB to bring the live paths in slots 0 to items - 1
// of one store to the front of another. An index order, which permutes the slots, is dropped.
template <class Algorithm>
class CubPayloadCompaction final : public Compaction {
public:
    explicit CubPayloadCompaction(const CellContext& cell) : cell_(cell) {}

    bool needs_spare_paths() const override { return true; }
    void reserve(Arena& arena, const Queue& queue) override {
        storage_.reserve(arena, [&](void* memory, std::size_t& bytes) {
            return call(memory, bytes, PathStore{}, PathStore{}, SlotAt{}, IsAlive{}, nullptr, queue.capacity);
        });
    }
    void compact(Queue& queue) override {
        queue.indirect = false;
        if (queue.bound == 0) {
            return;
        }
        storage_.run([&](void* memory, std::size_t& bytes) {
            return call(memory, bytes, queue.paths, queue.spare, slot_at(queue), is_alive(queue, cell_),
                        queue.count_spare, queue.bound);
        });
        *cell_.launches += 1;
        queue.swap_paths();
        queue.swap_count();
    }

private:
    cudaError_t call(void* memory, std::size_t& bytes, const PathStore& from, const PathStore& to,
                     const SlotAt& slot_at, const IsAlive& is_alive, std::uint32_t* count, std::uint32_t items) const {
        return visit_layout(cell_.layout_name, [&](auto paths) {
            return Algorithm::template paths<typename decltype(paths)::type>(
                memory, bytes, from, to, slot_at, is_alive, count, static_cast<int>(items), cell_.stream);
        });
    }

    CellContext cell_;
    CubStorage storage_;
};

inline constexpr Tunable payload_tunables[] = {
    {.name = "payload",
     .default_value = 0,
     .lowest = 0,
     .highest = 1,
     .summary = "1: the paths are moved, into a second store; 0: slot numbers are"},
};

// Why a CUB compaction with the tunable `payload` cannot run; empty: it can.
inline Reason payload_needs_single_precision(FeatureSet features, const VariantTraits& variant) {
    const auto tuned = variant.tuning.find("payload");
    return tuned != variant.tuning.end() && tuned->second != 0 ? needs_single_precision(features, variant) : Reason{};
}

// Makes the CUB compaction that the tunable `payload` asks for, of paths or of slot numbers.
template <class Algorithm>
std::unique_ptr<Compaction> make_cub_compaction(const CellContext& cell) {
    if (cell.tunable("payload") != 0) {
        return std::make_unique<CubPayloadCompaction<Algorithm>>(cell);
    }
    return std::make_unique<CubIndexCompaction<Algorithm>>(cell);
}

}  // namespace pt::cuda
