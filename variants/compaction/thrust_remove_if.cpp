// Removes the ended paths, keeping the order of the others; the whole payload is moved (seed A).
#include <thrust/remove.h>

#include "variants/cpu/thrust_compaction.h"

namespace pt {
namespace {

struct Algorithm {
    template <class Iterator>
    Iterator operator()(Iterator first, Iterator last) const {
        return thrust::remove_if(thrust::omp::par, first, last, HasEnded());
    }
};

const Registration registration(
    {
        .axis = "compaction",
        .name = "thrust_remove_if",
        .summary = "thrust::remove_if on the payload; order kept",
        .origin = "seed A (2023)",
        .check_counters = compacted_every_bounce,
    },
    {.compaction = [] { return std::make_unique<PayloadCompaction<Algorithm>>(); }});

}  // namespace
}  // namespace pt
