// Parts shared by the Thrust compactions that move the paths themselves.
#pragma once

#include "variants/cuda/queue_kernels.h"
#include "variants/cuda/register.h"
#include "variants/cuda/thrust_policy.h"
#include "variants/layout/payload_iterator.cuh"
#include "variants/work_checks.h"

namespace pt::cuda {

// Sets the count and the bound of the paths in play, once Thrust has returned the count to the host.
inline void set_count(Queue& queue, std::uint32_t count, const CellContext& cell) {
    queue.bound = count;
    set_value(queue.count, count, cell.stream);
    *cell.launches += 1;
}

// Thrust compaction of the paths themselves. `algorithm(policy, first, last)` works on an iterator over paths in any
// layout, brings the live paths to the front and returns their end. The slots in play are 0 to bound - 1 before: the
// bound is the count, since every Thrust compaction returns it, and a sort of indices only permutes. So an index order
// is dropped.
template <class Algorithm>
class ThrustPayloadCompaction final : public Compaction {
public:
    explicit ThrustPayloadCompaction(const CellContext& cell) : cell_(cell), thrust_(cell) {}

    void compact(Queue& queue) override {
        queue.indirect = false;
        if (queue.bound == 0) {
            return;
        }
        const std::ptrdiff_t count = visit_layout(cell_.layout_name, [&](auto paths) {
            const auto first = payload_begin<typename decltype(paths)::type>(queue.paths);
            return thrust_.for_count([&](const auto& policy) {
                return static_cast<std::ptrdiff_t>(
                    Algorithm()(policy, first, first + static_cast<std::ptrdiff_t>(queue.bound)) - first);
            });
        });
        set_count(queue, static_cast<std::uint32_t>(count), cell_);
    }

    static std::unique_ptr<Compaction> make(const CellContext& cell) {
        return std::make_unique<ThrustPayloadCompaction>(cell);
    }

private:
    CellContext cell_;
    ThrustCalls thrust_;
};

}  // namespace pt::cuda
