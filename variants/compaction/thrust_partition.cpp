// Brings the live paths to the front and the ended ones to the back, in any order; the payload is moved (seed B).
#include <thrust/partition.h>

#include "variants/cpu/thrust_compaction.h"

namespace pt {
namespace {

struct Algorithm {
    template <class Iterator>
    Iterator operator()(Iterator first, Iterator last) const {
        return thrust::partition(thrust::omp::par, first, last, IsAlive());
    }
};

const Registration registration(
    {
        .axis = "compaction",
        .name = "thrust_partition",
        .summary = "thrust::partition on the payload; order not promised",
        .origin = "seed B (2022)",
        .check_counters = compacted_every_bounce,
    },
    {.compaction = [] { return std::make_unique<PayloadCompaction<Algorithm>>(); }});

}  // namespace
}  // namespace pt
