#include "harness/cuda/memory_bound.h"

#include <algorithm>
#include <cmath>

namespace pt::cuda {

double least_seconds(double bytes, const std::vector<GpuCopyRate>& rates) {
    const auto larger =
        std::find_if(rates.begin(), rates.end() - 1, [&](const GpuCopyRate& r) { return r.bytes >= bytes; });
    if (larger == rates.begin() || larger->bytes <= bytes) {
        return 1e-9 * bytes / larger->gb_per_s;
    }
    const GpuCopyRate& smaller = larger[-1];
    const double share = std::log2(bytes / smaller.bytes) / std::log2(larger->bytes / smaller.bytes);
    return 1e-9 * bytes / (smaller.gb_per_s + share * (larger->gb_per_s - smaller.gb_per_s));
}

MemoryBound bound_of(const LeastBytes& least, const std::vector<std::uint64_t>& live, std::uint32_t longest_path,
                     std::uint32_t passes_per_segment, const std::vector<GpuCopyRate>& rates) {
    MemoryBound bound;
    for (std::size_t k = 0; k < live.size() && k + 1 < longest_path; ++k) {
        const auto before = static_cast<double>(live[k]);
        const double after = k + 1 < live.size() ? static_cast<double>(live[k + 1]) : 0;
        const double bytes = (least.a_path + (k > 0 ? least.a_listed : 0)) * before + least.a_survivor * after;
        bound.bytes += bytes;
        bound.ms += 1e3 * passes_per_segment * least_seconds(bytes / passes_per_segment, rates);
    }
    return bound;
}

}  // namespace pt::cuda
