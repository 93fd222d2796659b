#include <thrust/copy.h>

#include "variants/compaction/thrust_copy_if_index.h"
#include "variants/cuda/live_slots.h"
#include "variants/cuda/thrust_compaction.h"

namespace pt::cuda::compaction::thrust_copy_if_index {
namespace {

class CopyIfIndex final : public Compaction {
public:
    bool moves_paths() const override { return false; }
    explicit CopyIfIndex(const CellContext& cell) : cell_(cell), thrust_(cell) {}

    // All positions below queue.bound are in play, since every Thrust compaction returns the count to the host.
    void compact(Queue& queue) override {
        if (queue.bound == 0) {
            return;
        }
        const IsAlive alive = is_alive(queue, cell_);
        const auto select = [&](auto first) {
            return thrust_.for_count([&](const auto& policy) {
                return static_cast<std::uint32_t>(
                    thrust::copy_if(policy, first, first + queue.bound, queue.order_spare, alive) - queue.order_spare);
            });
        };
        const std::uint32_t count =
            queue.indirect ? select(queue.order) : select(thrust::counting_iterator<std::uint32_t>(0));
        queue.swap_order();
        queue.indirect = true;
        set_count(queue, count, cell_);
    }

private:
    CellContext cell_;
    ThrustCalls thrust_;
};

const Registration registration(on_device(pt::thrust_copy_if_index),
                                {.compaction = [](const CellContext& cell) -> std::unique_ptr<Compaction> {
                                    return std::make_unique<CopyIfIndex>(cell);
                                }});

}  // namespace
}  // namespace pt::cuda::compaction::thrust_copy_if_index
