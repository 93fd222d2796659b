#include <thrust/partition.h>

#include "variants/compaction/thrust_partition.h"
#include "variants/cuda/thrust_compaction.h"

namespace pt::cuda::compaction::thrust_partition {
namespace {

struct Algorithm {
    template <class Policy, class Iterator>
    Iterator operator()(const Policy& policy, Iterator first, Iterator last) const {
        return thrust::partition(policy, first, last, PathIsAlive());
    }
};

const Registration registration(on_device(pt::thrust_partition, needs_single_precision),
                                {.compaction = &ThrustPayloadCompaction<Algorithm>::make});

}  // namespace
}  // namespace pt::cuda::compaction::thrust_partition
