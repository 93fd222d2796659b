#include <thrust/remove.h>

#include "variants/compaction/thrust_remove_if.h"
#include "variants/cuda/thrust_compaction.h"

namespace pt::cuda::compaction::thrust_remove_if {
namespace {

struct Algorithm {
    template <class Policy, class Iterator>
    Iterator operator()(const Policy& policy, Iterator first, Iterator last) const {
        return thrust::remove_if(policy, first, last, PathHasEnded());
    }
};

const Registration registration(on_device(pt::thrust_remove_if, needs_single_precision),
                                {.compaction = &ThrustPayloadCompaction<Algorithm>::make});

}  // namespace
}  // namespace pt::cuda::compaction::thrust_remove_if
