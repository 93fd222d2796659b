// What the integrators with a queue have in common on the host's side.
#pragma once

#include <algorithm>
#include <numeric>
#include <stdexcept>
#include <vector>

#include "variants/cuda/megakernels.h"

namespace pt::cuda {

inline constexpr Tunable wavefront_tunables[] = {
    {"block", 256, 32, 1024, 32, "threads a block"},
    shading_tunable,
    // 64 registers a thread at the standard block: with six materials shading takes more, and the queue waits for
    // memory that more threads would hide (H200: 0.76 to 0.79 of the time with six materials, no difference with two).
    {"min_blocks", 4, min_blocks_tunable.lowest, min_blocks_tunable.highest, 1, min_blocks_tunable.summary},
    {"spp_in_flight", 1, 1, 256, 1, "samples of every pixel in the queue at once"},
    {"read_back", 0, 0, 1, 1, "1: the host waits for the count after each compaction and launches no more than that"},
};

inline std::string wavefront_work_missing(const WorkCounters& work, std::uint64_t) {
    if (work.bounces == 0) {
        return "ran no queue";
    }
    return work.launches == 0 ? "launched no kernel" : "";
}

// Runs the job's compaction, unless the integrator's kernel has done it. The host learns the count if it reads back.
inline void compact(Job& job, Queue& queue) {
    const Stage stage(job.stages, "compact", job.stream);
    if (!job.appends_in_kernel) {
        job.compaction->compact(queue);
    }
    job.work.compactions += 1;
    if (job.reads_back) {
        const std::uint32_t parts = job.appends_in_kernel ? job.append_counters : 1;
        PT_CUDA_CHECK(cudaMemcpy2DAsync(job.pinned_count, sizeof(std::uint32_t), queue.count,
                                        32 * sizeof(std::uint32_t), sizeof(std::uint32_t), parts,
                                        cudaMemcpyDeviceToHost, job.stream));
        PT_CUDA_CHECK(cudaStreamSynchronize(job.stream));
        queue.bound = std::accumulate(job.pinned_count, job.pinned_count + parts, 0u);
        job.work.host_waits += 1;
    }
}

// Without a read-back nobody tells the host that all paths of a batch have ended. Where they may be long enough for
// that to cost more than asking, it asks now and then. A batch that is captured cannot ask.
inline bool asks_for_the_end(const Job& job, std::uint32_t segment) {
    constexpr std::uint32_t segments_between = 512;
    const bool is_told = job.reads_back && job.compaction != nullptr;
    return !is_told && job.cursor == nullptr && job.longest_path > few_segments && segment % segments_between == 0;
}

// The device counts the paths that each segment finds alive. Made before the segment is enqueued; the pinned words are
// those of a read-back, which there is none of where this asks.
class EndOfPaths {
public:
    EndOfPaths(Job& job, std::uint32_t segment)
        : job_(job),
          asks_(asks_for_the_end(job, segment)),
          live_(job.segments.live + segment),
          counts_(reinterpret_cast<std::uint64_t*>(job.pinned_count)) {
        if (asks_) {
            read(0);
        }
    }
    // Whether no path was alive in the segment, which has been enqueued by now.
    bool is_reached() {
        if (!asks_) {
            return false;
        }
        read(1);
        PT_CUDA_CHECK(cudaStreamSynchronize(job_.stream));
        job_.work.host_waits += 1;
        return counts_[0] == counts_[1];  // it counts earlier batches too
    }

private:
    void read(int i) {
        PT_CUDA_CHECK(cudaMemcpyAsync(counts_ + i, live_, sizeof *live_, cudaMemcpyDeviceToHost, job_.stream));
    }

    Job& job_;
    bool asks_;
    const std::uint64_t* live_;
    std::uint64_t* counts_;
};

// The body of a loop must leave the queue as it found it: what it swaps, it swaps back.
inline void check_round_trip(const Queue& before, const Queue& after) {
    if (before.paths.base != after.paths.base || before.order != after.order || before.keys != after.keys ||
        before.count != after.count || before.bound != after.bound || before.indirect != after.indirect) {
        throw std::logic_error("a round of the graph's loop leaves the queue otherwise than it found it");
    }
}

}  // namespace pt::cuda
