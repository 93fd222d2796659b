// The host's side of walks that a queue's paths take in a kernel of their own (device/walkers.h).
#pragma once

#include <algorithm>

#include "variants/cuda/device/walkers.h"
#include "variants/cuda/integrator.h"

namespace pt::cuda {

inline constexpr Tunable walks_tunable{
    "walks_apart", 1, 0, 1, 1, "subsurface walks: 1: in a kernel of their own; 0: to their end where paths are shaded"};

// The kernel that takes walks belongs to programs for scenes that have some.
inline constexpr const char* walk_paths_source = "variants/cuda/device/walk_paths.cuh";

inline std::vector<KernelConstant> walks_constants(const Variant& variant) {
    return {{"walks_apart", tunable(variant, "walks_apart", Backend::cuda)}};
}

template <class Real>
class Walks {
public:
    // `paths`: as many as there may be in the queue. `parts`: of the queue, each with a counter, where kernels append.
    Walks(JobOf<Real>& job, const IntegratorNeeds& needs, std::uint32_t paths, std::uint32_t parts = 1)
        : job_(job),
          walker_bytes_(walker_bytes<Real>(contains(needs.features, Feature::guided_walk))),
          paths_(paths),
          parts_(parts),
          are_apart_(contains(needs.features, Feature::subsurface) && needs.tunable("walks_apart") != 0) {
        if (are_apart_) {
            blocks_ = static_cast<std::uint32_t>(
                          job.module->blocks_per_multiprocessor(WalkPathsParameters<Real>::kernel, job.block)) *
                      job.multiprocessors;
        }
    }

    bool are_apart() const { return are_apart_; }
    void reserve(Arena& arena) {
        if (are_apart_) {
            list_ = {arena.take_bytes(walker_bytes_ * paths_), arena.take<WalkerCounts>(1)};
        }
    }
    // Enqueues the start of a batch: no path is on a walk.
    void begin() {
        if (are_apart_) {
            clear(list_.counts, sizeof *list_.counts, job_.stream);
        }
    }
    const WalkerList& list() const { return list_; }

    // Enqueues the walks of the list to their ends. Paths stay in their slots of `in`.
    void take_in_place(const PathStore& in) { take(in, {}, nullptr, {}); }
    // Enqueues the walks of the list, whose paths lie in `in`, to their ends, after which they are appended to `out`.
    void take_to(const PathStore& in, const PathStore& out, std::uint32_t* out_count, const SegmentNumber& segment) {
        take(in, out, out_count, segment);
    }

private:
    void take(const PathStore& in, const PathStore& out, std::uint32_t* out_count, const SegmentNumber& segment) {
        if (are_apart_) {
            const Stage stage(job_.stages, "walk", job_.stream);
            job_.launch_blocks(std::min(blocks_, (paths_ + job_.block - 1) / job_.block),
                               WalkPathsParameters<Real>{job_.scene, job_.film, list_, in, out, out_count, parts_,
                                                         segment, job_.totals});
        }
    }

    JobOf<Real>& job_;
    std::size_t walker_bytes_;
    std::uint32_t paths_, parts_;
    bool are_apart_;
    std::uint32_t blocks_ = 0;
    WalkerList list_;
};

}  // namespace pt::cuda
