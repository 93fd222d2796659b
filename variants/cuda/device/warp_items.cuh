// A warp that works off samples of strips of 32 pixels and stays full: a lane whose path has ended takes a path that
// waits in shared memory, and once too few wait, all lanes put theirs there and begin the next 32 paths together, so
// that camera rays are made, traced and shaded by full warps, side by side, without atomic operations. Shared by the
// integrators megakernel_regen and persistent.
#pragma once

#include "variants/cuda/device/branches.cuh"
#include "variants/cuda/device/waiting_paths.cuh"

// What a warp begins together: one sample of each of 32 pixels in a row. Pixels beyond the image's last one have no
// path.
struct Round {
    pt::PixelPlace first;  // first pixel of the warp's strip, among the pixels of this device
    std::uint32_t sample;

    // The pixel of the calling lane. The division by the image's width is made once a strip instead of once a path.
    __device__ pt::PixelPlace place(std::uint32_t width) const {
        const std::uint32_t step = pt::cuda::lane();
        if (width < warp_size) {
            return pt::PixelPlace::of(first.index + step, width);
        }
        const std::uint32_t x = first.x + step;
        const bool wraps = x >= width;
        return {first.index + step, wraps ? x - width : x, first.y + (wraps ? 1u : 0u)};
    }
};

// Most bytes of shared memory for waiting paths: what a traversal's stacks and a kernel's sums leave of the 48 KiB that
// a block has without asking for more.
#ifdef PT_STACK_BYTES
inline constexpr std::size_t most_waiting_bytes = 47 * 1024 - PT_STACK_BYTES - scene_bytes_shared;
#else
inline constexpr std::size_t most_waiting_bytes = 47 * 1024 - scene_bytes_shared;
#endif

// Traces the paths that `rounds` gives: rounds.take(Round&, counters) sets the next round, or returns false once there
// is none. Every lane of the warp must call it, with the same rounds. `ended`: counters of paths by their number of
// segments, or null. The loop ends at its condition: nvcc 13.0's ptxas miscompiles a break out of the middle.
template <class Rounds>
__device__ inline void trace_items(const SceneViews& scene, const FilmView& film, Rounds& rounds, std::uint32_t pixels,
                                   const HitCache& cache, ThreadCounters& counters, std::uint64_t* ended) {
    constexpr std::uint32_t warps = (kernel_config.block + warp_size - 1) / warp_size;
    // Paths wait in shared memory only if it has room for them, and not if they split: branches stay with their lane.
    // Otherwise a warp begins paths only once all of its paths have ended.
    constexpr bool may_wait =
        !pt::has<Configuration>(pt::Feature::splitting) && warps * sizeof(WaitingPaths) <= most_waiting_bytes;
    __shared__ WaitingPaths waiting_of_warp[may_wait ? warps : 1];
    WaitingPaths& waiting = waiting_of_warp[may_wait ? threadIdx.x / warp_size : 0];
    std::uint32_t waiting_count = 0;  // number of the warp's paths that wait in shared memory; the same in all lanes
    unsigned held = 0;                // the lanes of the warp that hold a path, alive or ended; the same in all lanes
    bool alive = false;
    pt::WalkOf<Configuration> walk;
    Path path;
    BranchesHere branches;
    do {
        const unsigned living = __ballot_sync(pt::cuda::all_lanes, alive);
        if (__popc(living) <= static_cast<int>(may_wait ? tuned::regenerate_at : 0)) {
            const unsigned before = (1u << pt::cuda::lane()) - 1u;
            if (!alive && ((held >> pt::cuda::lane()) & 1u) != 0) {
                pt::accumulate(film, path);
                counters.rays += branches.rays(path) - (kernel_config.keeps_first_hits ? 1 : 0);
                counters.paths += 1;
                if (ended != nullptr) {
                    pt::atomic_add(&ended[branches.longest(path) - 1], std::uint64_t{1});
                }
            }
            const std::uint32_t wanted = __popc(~living);
            Round round;
            if (wanted > waiting_count && rounds.take(round, counters)) {
                // WaitingPaths has room, since fewer than 32 paths of the warp wait or live.
                if (may_wait && alive) {
                    waiting.put(waiting_count + __popc(living & before), path, walk);
                }
                waiting_count += __popc(living);
                const pt::PixelPlace place = round.place(scene.shade.camera.width);
                path =
                    first_path(scene.shade, pt::cuda::in_image(place, scene.shade.camera.width), round.sample, cache);
                walk = {};
                branches.start_again();
                alive = place.index < pixels;
            } else {
                const std::uint32_t rank = __popc(~living & before);
                if (may_wait && !alive && rank < waiting_count) {
                    waiting.get(waiting_count - 1 - rank, scene.shade, path, walk);
                    alive = true;
                }
                waiting_count -= min(wanted, waiting_count);
            }
            __syncwarp();
            held = __ballot_sync(pt::cuda::all_lanes, alive);
        }
        if (alive) {
            alive = branches.take_step(scene, path, walk, cache, counters);
        }
    } while (held != 0);
}
