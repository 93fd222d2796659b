// Host side of subsurface walks that a queue's paths take in a kernel of their own (device/walkers.h).
#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "variants/cuda/device/walkers.h"
#include "variants/cuda/integrator.h"

namespace pt::cuda {

inline constexpr Tunable walks_tunable{
    "walks_apart", 1, 0, 1, 1, "subsurface walks: 1: in a kernel of their own; 0: to their end where paths are shaded"};

// The kernel for subsurface walks in queues whose paths all do one segment before any of them does the next.
inline constexpr KernelPart walk_paths_part = kernel_part<WalkPathsParameters>("variants/cuda/device/walk_paths.cuh");

inline std::vector<KernelConstant> walks_constants(const Variant& variant) {
    return {{"walks_apart", tunable(variant, "walks_apart", Backend::cuda)}};
}

// Makes lists of walkers for a queue of at most `paths` paths; none where walks are not left to a kernel of their own.
template <class Real, int lists>
class WalkerLists {
public:
    WalkerLists(JobOf<Real>& job, const IntegratorNeeds& needs, std::uint32_t paths, const char* kernel)
        : job_(job),
          walker_bytes_(walker_bytes<Real>(contains(needs.features, Feature::guided_walk))),
          paths_(paths),
          are_apart_(contains(needs.features, Feature::subsurface) && needs.tunable("walks_apart") != 0) {
        if (are_apart_) {
            const auto fit = static_cast<std::uint32_t>(job.module->blocks_per_multiprocessor(kernel, job.block)) *
                             job.multiprocessors;
            blocks_ = std::min(fit, (paths + job.block - 1) / job.block);
        }
    }

    bool are_apart() const { return are_apart_; }
    // Number of blocks of the walk kernel: as many as the device holds at once.
    std::uint32_t blocks() const { return blocks_; }
    void reserve(Arena& arena) {
        for (int i = 0; are_apart_ && i < lists; ++i) {
            lists_[i] = {arena.take_bytes(walker_bytes_ * paths_), arena.take<ListCounts>(1)};
        }
    }
    // Enqueues the start of a batch, in which no path is on a walk.
    void begin() {
        for (int i = 0; are_apart_ && i < lists; ++i) {
            clear(lists_[i].counts, sizeof(ListCounts), job_.stream);
        }
    }
    const WalkerList& list(int i = 0) const { return lists_[i]; }
    void swap_lists() { std::swap(lists_[0], lists_[lists - 1]); }

private:
    JobOf<Real>& job_;
    std::size_t walker_bytes_;
    std::uint32_t paths_;
    bool are_apart_;
    std::uint32_t blocks_ = 0;
    WalkerList lists_[lists];
};

// The walks of queues whose paths all do a segment before any does the next: taken to their ends between segments.
template <class Real>
class Walks : public WalkerLists<Real, 1> {
public:
    // `parts`: number of parts of the queue, each with a counter, where an integrator's kernel appends paths.
    Walks(JobOf<Real>& job, const IntegratorNeeds& needs, std::uint32_t paths, std::uint32_t parts = 1)
        : WalkerLists<Real, 1>(job, needs, paths, WalkPathsParameters<Real>::kernel), job_(job), parts_(parts) {}

    // Enqueues the walks of a list of walkers. Paths stay in their slots of `in`.
    void take_in_place(const PathStore& in) { take(in, {}, nullptr, {}); }
    // Enqueues the walks of a list of walkers, whose paths lie in `in`; each path is then appended to `out`.
    void take_to(const PathStore& in, const PathStore& out, std::uint32_t* out_count, const SegmentNumber& segment) {
        take(in, out, out_count, segment);
    }

private:
    void take(const PathStore& in, const PathStore& out, std::uint32_t* out_count, const SegmentNumber& segment) {
        if (this->are_apart()) {
            const Stage stage(job_.stages, "walk", job_.stream);
            job_.launch_blocks(this->blocks(), WalkPathsParameters<Real>{job_.scene, job_.film, this->list(), in, out,
                                                                         out_count, parts_, segment, job_.totals});
        }
    }

    JobOf<Real>& job_;
    std::uint32_t parts_;
};

}  // namespace pt::cuda
