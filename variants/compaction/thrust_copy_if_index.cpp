#include <thrust/copy.h>
#include <thrust/iterator/counting_iterator.h>

#include "variants/compaction/thrust_compaction.h"
#include "variants/compaction/thrust_copy_if_index.h"

namespace pt {
namespace {

class CopyIfIndex final : public Compaction {
public:
    void compact(PathQueue& queue) override {
        std::visit(
            [&](const auto& paths) {
                const auto is_alive = [&paths](std::uint32_t slot) { return paths.alive(slot); };
                const auto count = static_cast<std::ptrdiff_t>(queue.count);
                std::uint32_t* const kept = queue.scratch.data();
                std::uint32_t* end = kept;
                if (queue.indirect) {
                    end = thrust::copy_if(thrust::omp::par, queue.order.data(), queue.order.data() + count, kept,
                                          is_alive);
                } else {
                    const auto first = thrust::counting_iterator<std::uint32_t>(0);
                    end = thrust::copy_if(thrust::omp::par, first, first + count, kept, is_alive);
                }
                queue.count = static_cast<std::size_t>(end - kept);
            },
            queue.paths);
        std::swap(queue.order, queue.scratch);
        queue.indirect = true;
    }
};

const Registration registration(thrust_copy_if_index, {.compaction = [] { return std::make_unique<CopyIfIndex>(); }});

}  // namespace
}  // namespace pt
