// Like thrust_partition, but both groups keep their order.
#include <thrust/partition.h>

#include "variants/cpu/thrust_compaction.h"

namespace pt {
namespace {

struct Algorithm {
    template <class Iterator>
    Iterator operator()(Iterator first, Iterator last) const {
        return thrust::stable_partition(thrust::omp::par, first, last, IsAlive());
    }
};

const Registration registration(
    {
        .axis = "compaction",
        .name = "thrust_stable_partition",
        .summary = "thrust::stable_partition on the payload; order kept",
        .origin = "CIS 565 project 3",
        .check_counters = compacted_every_bounce,
    },
    {.compaction = [] { return std::make_unique<PayloadCompaction<Algorithm>>(); }});

}  // namespace
}  // namespace pt
