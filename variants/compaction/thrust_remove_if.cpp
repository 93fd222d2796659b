#include <thrust/remove.h>

#include "variants/compaction/thrust_compaction.h"
#include "variants/compaction/thrust_remove_if.h"

namespace pt {
namespace {

struct Algorithm {
    template <class Iterator>
    Iterator operator()(Iterator first, Iterator last) const {
        return thrust::remove_if(thrust::omp::par, first, last, HasEnded());
    }
};

const Registration registration(thrust_remove_if,
                                {.compaction = [] { return std::make_unique<PayloadCompaction<Algorithm>>(); }});

}  // namespace
}  // namespace pt
