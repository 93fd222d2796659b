// Removes the ended paths, keeping the order of the others; the whole payload is moved (seed A).
#include <thrust/remove.h>

#include "variants/cuda/thrust_compaction.h"

namespace pt::cuda {
namespace {

struct Algorithm {
    template <class Policy, class Iterator>
    Iterator operator()(const Policy& policy, Iterator first, Iterator last) const {
        return thrust::remove_if(policy, first, last, PathHasEnded());
    }
};

const Registration registration(
    {
        .axis = "compaction",
        .name = "thrust_remove_if",
        .summary = "thrust::remove_if on the payload; order kept",
        .origin = "seed A (2023)",
        .traits = CompactionTraits{.host_sync = true},
        .backends = on_cuda,
        .tunables = thrust_tunables,
        .unsupported_reason = needs_single_precision,
        .check_counters = compacted_every_bounce,
    },
    {.compaction = &ThrustPayloadCompaction<Algorithm>::make});

}  // namespace
}  // namespace pt::cuda
