// Brings the live paths to the front and the ended ones to the back, in any order; the payload is moved (seed B).
#include <thrust/partition.h>

#include "variants/cuda/thrust_compaction.h"

namespace pt::cuda {
namespace {

struct Algorithm {
    template <class Policy, class Iterator>
    Iterator operator()(const Policy& policy, Iterator first, Iterator last) const {
        return thrust::partition(policy, first, last, PathIsAlive());
    }
};

const Registration registration(
    {
        .axis = "compaction",
        .name = "thrust_partition",
        .summary = "thrust::partition on the payload; order not promised",
        .origin = "seed B (2022)",
        .traits = CompactionTraits{.host_sync = true},
        .backends = on_cuda,
        .tunables = thrust_tunables,
        .unsupported_reason = needs_single_precision,
        .check_counters = compacted_every_bounce,
    },
    {.compaction = &ThrustPayloadCompaction<Algorithm>::make});

}  // namespace
}  // namespace pt::cuda
