// What the Thrust compactions on the CPU share: predicates, and a compaction that moves whole paths.
#pragma once

#include <thrust/system/omp/execution_policy.h>

#include "variants/registry.h"
#include "variants/work_checks.h"

namespace pt {

struct IsAlive {
    bool operator()(const Path<float>& path) const { return path.alive(); }
};
struct HasEnded {
    bool operator()(const Path<float>& path) const { return !path.alive(); }
};

// A compaction that moves whole paths: `algorithm(first, last)` works on path iterators of any layout, brings the live
// paths to the front and returns their end. Slots stay contiguous, so an index order is dropped.
template <class Algorithm>
class PayloadCompaction final : public Compaction {
public:
    void compact(PathQueue& queue) override {
        queue.indirect = false;
        queue.count = std::visit(
            [&](auto& paths) {
                const auto first = paths.begin();
                return static_cast<std::size_t>(Algorithm()(first, first + static_cast<std::ptrdiff_t>(queue.count)) -
                                                first);
            },
            queue.paths);
    }
};

}  // namespace pt
