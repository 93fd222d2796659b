#include <thrust/partition.h>

#include "variants/compaction/thrust_compaction.h"
#include "variants/compaction/thrust_partition.h"

namespace pt {
namespace {

struct Algorithm {
    template <class Iterator>
    Iterator operator()(Iterator first, Iterator last) const {
        return thrust::partition(thrust::omp::par, first, last, IsAlive());
    }
};

const Registration registration(thrust_partition,
                                {.compaction = [] { return std::make_unique<PayloadCompaction<Algorithm>>(); }});

}  // namespace
}  // namespace pt
