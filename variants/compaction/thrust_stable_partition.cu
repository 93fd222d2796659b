// Like thrust_partition, but both groups keep their order.
#include <thrust/partition.h>

#include "variants/cuda/thrust_compaction.h"

namespace pt::cuda {
namespace {

struct Algorithm {
    template <class Policy, class Iterator>
    Iterator operator()(const Policy& policy, Iterator first, Iterator last) const {
        return thrust::stable_partition(policy, first, last, PathIsAlive());
    }
};

const Registration registration(
    {
        .axis = "compaction",
        .name = "thrust_stable_partition",
        .summary = "thrust::stable_partition on the payload; order kept",
        .origin = "CIS 565 project 3",
        .traits = CompactionTraits{.host_sync = true},
        .backends = on_cuda,
        .tunables = thrust_tunables,
        .unsupported_reason = needs_single_precision,
        .check_counters = compacted_every_bounce,
    },
    {.compaction = &ThrustPayloadCompaction<Algorithm>::make});

}  // namespace
}  // namespace pt::cuda
