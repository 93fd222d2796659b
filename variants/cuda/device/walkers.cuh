// How kernels put paths on a subsurface walk into a list of walkers, and take them out again.
#pragma once

#include "variants/cuda/device/append.cuh"
#include "variants/cuda/device/walkers.h"

// Whether kernels of this program leave walks to a kernel of their own.
inline constexpr bool walks_apart = pt::has<Configuration>(pt::Feature::subsurface) && tuned::walks_apart != 0;
using OwnWalk = pt::WalkOf<Configuration>;
using Walker = pt::cuda::Walker<OwnWalk>;

namespace pt::cuda {

// Appends walks that have begun to a list of walkers. Every lane of the warp must call it.
__device__ inline void put_walkers(const WalkerList& list, const OwnWalk& walk, std::uint32_t slot,
                                   std::uint32_t place) {
    const std::uint32_t position = append_by_warp(&list.counts->waiting, walk.is_on());
    if (walk.is_on()) {
        static_cast<::Walker*>(list.walkers)[position] = {slot, place, walk};
    }
}

// Hands out to lanes the walkers that are in a list.
class WalkersToTake {
public:
    __device__ explicit WalkersToTake(const WalkerList& list) : list_(list), waiting_(list.counts->waiting) {}

    // Whether the list may have walkers left; all lanes of a warp get the same answer.
    __device__ bool some_left() const { return some_left_; }
    // Takes a walker for every lane that `wants` one, while the list lasts; returns whether the calling lane got one.
    // Every lane of the warp must call it.
    __device__ bool take(bool wants, ::Walker& walker) {
        const std::uint32_t position = append_by_warp(&list_.counts->taken, wants);
        const bool has_one = wants && position < waiting_;
        some_left_ = __ballot_sync(all_lanes, wants && !has_one) == 0;
        if (has_one) {
            walker = static_cast<const ::Walker*>(list_.walkers)[position];
        }
        return has_one;
    }

private:
    WalkerList list_;
    std::uint32_t waiting_;
    bool some_left_ = true;
};

}  // namespace pt::cuda
