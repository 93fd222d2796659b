// What this build has. Without a CUDA toolkit some axes have no choice on that backend, so it has no variants.
#pragma once

#include <string>
#include <vector>

#include "variants/registry.h"

namespace pt::test {

inline bool cuda_is_built() { return !Registry::instance().choices("integrator", Backend::cuda).empty(); }

inline std::vector<Backend> built_backends() {
    return cuda_is_built() ? std::vector<Backend>{Backend::cpu, Backend::cuda} : std::vector<Backend>{Backend::cpu};
}

// The choices of an axis and the tunables on any backend of this build, as messages list them.
inline std::string compaction_names() {
    return (cuda_is_built() ? "atomic_append, block_scan_append, cub_partition, cub_select_flagged, cub_select_if, "
                              "cub_three_way, gap_fill, none, "
                            : "none, ") +
           std::string("thrust_copy_if_index, thrust_partition, thrust_remove_if, thrust_stable_partition");
}

inline std::string sorting_names() {
    return cuda_is_built() ? "bucket, cub_radix, cub_radix_full, none, per_material_queue, thrust_sort_by_key"
                           : "bucket, none, thrust_sort_by_key";
}

inline std::string tunable_names() {
    return cuda_is_built()
               ? "block, caching_allocator, jitters, par_nosync, payload, read_back, shading_fmas, spp_in_flight"
               : "jitters";
}

}  // namespace pt::test
