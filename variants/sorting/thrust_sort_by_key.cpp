// Sorts the paths and their hits by material before shading, moving the payload: what both seeds do.
// Keys are unsigned: CCCL 3.0.1's host radix sort puts negative keys last.
#include <thrust/iterator/zip_iterator.h>
#include <thrust/sort.h>
#include <thrust/system/omp/execution_policy.h>
#include <thrust/tuple.h>

#include "variants/registry.h"

namespace pt {
namespace {

class SortByKey final : public Sorting {
public:
    void sort(PathQueue& queue, std::uint32_t) override {
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
        .origin = "both seeds",
        .does_not_apply = [](FeatureSet, const Variant& variant) -> std::string {
            return variant["compaction"] == "thrust_copy_if_index"
                       ? "moves a contiguous payload, which compaction=thrust_copy_if_index does not keep"
                       : "";
        },
        .work_missing = [](const WorkCounters& work, std::uint64_t) -> std::string {
            return work.sorts == work.bounces && work.sorts > 0 ? "" : "did not sort in every bounce";
        },
    },
    {.sorting = [] { return std::make_unique<SortByKey>(); }});

}  // namespace
}  // namespace pt
