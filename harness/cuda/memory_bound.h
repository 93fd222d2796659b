// What the speed of memory allows the passes of a render over its queue of paths.
#pragma once

#include <cstdint>
#include <vector>

#include "variants/cuda/integrator.h"
#include "variants/render_job.h"

namespace pt {

// The rate of copies between two blocks of memory, again and again: blocks that the L2 cache holds are copied faster.
struct GpuCopyRate {
    double bytes = 0;     // bytes of both blocks together
    double gb_per_s = 0;  // 10^9 bytes read and written per second

    template <class Self, class Visit>
    static void fields(Self& self, const Visit& visit) {
        visit("bytes", self.bytes);
        visit("gb_per_s", self.gb_per_s);
    }
};

namespace cuda {

// Seconds that reading and writing so many bytes in all takes at least, by the rates of copies, by increasing size.
// Between two sizes the rate is interpolated over the logarithm of the size. Precondition: there are rates.
double least_seconds(double bytes, const std::vector<GpuCopyRate>& rates);

// The bound of a stage's passes: one after each segment but the last that a path may have, over the paths of all
// `passes_per_segment` batches together. live[k]: number of paths that traced segment k + 1.
MemoryBound bound_of(const LeastBytes& least, const std::vector<std::uint64_t>& live, std::uint32_t longest_path,
                     std::uint32_t passes_per_segment, const std::vector<GpuCopyRate>& rates);

}  // namespace cuda
}  // namespace pt
