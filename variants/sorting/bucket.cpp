// The sort `bucket` on the CPU, a counting sort of slot numbers by material: one histogram a block, one scan, one
// scatter. Paths stay in place. Cycles sorts its shading queue so (kernel/device/gpu/parallel_sorted_index.h).
#include <algorithm>

#include "variants/cpu/parallel_for.h"
#include "variants/registry.h"
#include "variants/work_checks.h"

namespace pt {
namespace {

class Bucket final : public Sorting {
public:
    void sort(PathQueue& queue, std::uint32_t key_count) override {
        const std::size_t block = std::max<std::size_t>(4096, queue.count / 64 + 1);
        const std::size_t blocks = (queue.count + block - 1) / block;
        offsets_.assign(blocks * key_count, 0);
        parallel_for(queue.count, block, [&](std::size_t begin, std::size_t end) {
            std::uint32_t* const counts = &offsets_[begin / block * key_count];
            for (std::size_t i = begin; i < end; ++i) {
                counts[queue.keys[i]] += 1;
            }
        });
        // Exclusive scan over keys, and over the blocks within a key: blocks stay in order, so the sort is stable.
        std::uint32_t next = 0;
        for (std::uint32_t key = 0; key < key_count; ++key) {
            for (std::size_t b = 0; b < blocks; ++b) {
                const std::uint32_t count = offsets_[b * key_count + key];
                offsets_[b * key_count + key] = next;
                next += count;
            }
        }
        parallel_for(queue.count, block, [&](std::size_t begin, std::size_t end) {
            std::uint32_t* const place = &offsets_[begin / block * key_count];
            for (std::size_t i = begin; i < end; ++i) {
                queue.scratch[place[queue.keys[i]]++] = queue.slot(i);
            }
        });
        std::swap(queue.order, queue.scratch);
        queue.indirect = true;
    }

private:
    std::vector<std::uint32_t> offsets_;  // by [block][key]: where the block's next slot number of this key goes
};

const Registration registration(
    {
        .axis = "sorting",
        .name = "bucket",
        .summary = "counting sort of slot numbers by material; the payload stays in place",
        .origin = "Cycles' sorted index array",
        // The bucket sort is stable on the CPU, but not on CUDA. Both backends declare that its order is not
        // reproducible, so that the same choices go together on both.
        .traits = SortingTraits{.reproducible_order = false},
        .check_counters = sorted_every_bounce,
    },
    {.sorting = [] { return std::make_unique<Bucket>(); }});

}  // namespace
}  // namespace pt
