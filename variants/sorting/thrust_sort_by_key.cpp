// The sort thrust_sort_by_key on the CPU: moves the paths and their hits into the order of materials before shading, as
// cis565 does. Keys are unsigned: CCCL 3.0.1's host radix sort puts negative keys last.
#include <stdexcept>

#include <thrust/iterator/zip_iterator.h>
#include <thrust/sort.h>
#include <thrust/system/omp/execution_policy.h>
#include <thrust/tuple.h>

#include "variants/registry.h"
#include "variants/sorting/contiguous_payload.h"
#include "variants/work_checks.h"

namespace pt {
namespace {

class SortByKey final : public Sorting {
public:
    void sort(PathQueue& queue, std::uint32_t) override {
        if (queue.indirect) {
            throw std::logic_error("thrust_sort_by_key needs a contiguous payload");
        }
        std::visit(
            [&](auto& paths) {
                thrust::sort_by_key(thrust::omp::par, queue.keys.data(), queue.keys.data() + queue.count,
                                    thrust::make_zip_iterator(thrust::make_tuple(paths.begin(), queue.hits.data())));
            },
            queue.paths);
    }
};

const Registration registration(
    {
        .axis = "sorting",
        .name = "thrust_sort_by_key",
        .summary = "thrust::sort_by_key by material, path and hit moved",
        .origin = "cis565",
        .unsupported_reason = [](FeatureSet,
                                 const VariantTraits& variant) { return needs_contiguous_payload(variant); },
        .check_counters = sorted_every_bounce,
    },
    {.sorting = [] { return std::make_unique<SortByKey>(); }});

}  // namespace
}  // namespace pt
