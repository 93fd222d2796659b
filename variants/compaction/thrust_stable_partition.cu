#include <thrust/partition.h>

#include "variants/compaction/thrust_stable_partition.h"
#include "variants/cuda/thrust_compaction.h"

namespace pt::cuda::compaction::thrust_stable_partition {
namespace {

struct Algorithm {
    template <class Policy, class Iterator>
    Iterator operator()(const Policy& policy, Iterator first, Iterator last) const {
        return thrust::stable_partition(policy, first, last, PathIsAlive());
    }
};

const Registration registration(on_device(pt::thrust_stable_partition, needs_single_precision),
                                {.compaction = &ThrustPayloadCompaction<Algorithm>::make});

}  // namespace
}  // namespace pt::cuda::compaction::thrust_stable_partition
