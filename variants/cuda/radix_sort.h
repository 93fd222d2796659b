// What the CUB radix sorts share: slot numbers are sorted by key, stably, and the paths themselves stay in place.
#pragma once

#include "variants/cuda/cub_storage.h"
#include "variants/cuda/stages.h"

namespace pt::cuda {

// The bits of a sort key that a radix sort looks at: those that the scene's keys need, or all 32.
enum class KeyBits { needed, all };

// Sorts slot numbers by key. The result is an order for every position up to the bound; the keys are overwritten.
class RadixSort final : public Sorting {
public:
    bool moves_paths() const override { return false; }
    RadixSort(const CellContext& cell, KeyBits key_bits) : cell_(cell), key_bits_(key_bits) {}
    void reserve(Arena& arena, const Queue& queue) override;
    void sort(Queue& queue, std::uint32_t key_count) override;

private:
    CellContext cell_;
    KeyBits key_bits_;
    CubStorage storage_;
};

}  // namespace pt::cuda
