// What the integrators with a queue have in common on the host's side: the queue's memory, its batches of samples, and
// the loop over the segments of a batch.
#pragma once

#include <vector>

#include "variants/cuda/batches.h"
#include "variants/cuda/megakernels.h"
#include "variants/cuda/runtime/handles.h"

namespace pt::cuda {

inline constexpr Tunable wavefront_tunables[] = {
    {"block", 256, 32, 1024, 32, "threads a block"},
    shading_tunable,
    // The default of min_blocks leaves a thread 64 registers at the standard block: with six materials shading takes
    // more, and the queue waits for memory that more threads would hide (H200: 0.76 to 0.79 of the time with six
    // materials, no difference with two). A kernel with every feature has no such bound, under which it would keep a
    // kilobyte a thread in local memory.
    {.name = "min_blocks",
     .default_value = 4,
     .lowest = min_blocks_tunable.lowest,
     .highest = min_blocks_tunable.highest,
     .summary = "blocks that a multiprocessor must hold at once: bounds a thread's registers; half as many in double "
                "precision; 0: no bound, the default where a kernel has every feature (specialisation=generic)",
     .generic_value = 0},
    {"spp_in_flight", 1, 1, 256, 1, "samples of every pixel in the queue at once"},
    {"read_back", 0, 0, 1, 1, "1: the host waits for the count after each compaction and launches no more than that"},
};

inline std::string wavefront_work_missing(const WorkCounters& work, std::uint64_t) {
    if (work.bounces == 0) {
        return "ran no queue";
    }
    return work.launches == 0 ? "launched no kernel" : "";
}

// Base class of the integrators with a queue: a derived class tells how a batch begins and what a segment is. One that
// does not take its samples in batches has a loop of its own.
class Wavefront : public Integrator {
public:
    void reserve(Arena& arena) final;
    void upload() final;
    void prepare() final;
    void render() override;
    WorkCounters device_work() const final { return batches_.loop_work(); }
    PathBytes path_bytes() const final { return path_bytes_; }
    LeastTraffic least_traffic() const final;

protected:
    // Constructs a wavefront. hit_bytes: size of a hit that is stored between two kernels; 0: none is.
    Wavefront(Job& job, IntegratorNeeds&& needs, std::size_t real_bytes, std::size_t hit_bytes);

    // Enqueues the kernel that starts the first queue_.bound paths of queue_, and may trace their first segment, too.
    virtual void begin(std::uint32_t first_sample) = 0;
    // Enqueues a segment of the paths in queue_, without the compaction after it.
    virtual void trace(std::uint32_t segment) = 0;
    virtual void fill_first_hits() = 0;

    // Number of parts of the queue, each with a counter, to which an integrator's own kernel appends live paths
    // (appends_).
    virtual std::uint32_t parts() const { return 1; }
    // Number of slots that a store needs for so many paths, where kernels append.
    virtual std::uint32_t slots_for(std::uint32_t paths) const;
    virtual void reserve_counts(Arena&) {}
    // Ends a graph loop's round of two segments and returns where the paths that live are counted. Leaves queue_.count
    // where the next round expects it.
    virtual LiveCounts end_round(const Queue& before);

    // Resets queue_ to the state in which a batch starts, with `paths` paths in play.
    void start_queue(std::uint32_t paths);
    // Counts a segment that was enqueued, and compacts the queue where the kernel has not appended to it.
    void end_segment(std::uint32_t segment);
    bool is_last(std::uint32_t segment) const { return segment + 1 == job_.longest_path; }
    const std::uint32_t* order() const { return queue_.indirect ? queue_.order : nullptr; }
    const IntegratorNeeds& needs() const { return needs_; }
    const Batches& batches() const { return batches_; }

    Queue queue_;  // queue of the batch that is being enqueued
    const bool appends_;

private:
    class EndOfPaths;

    void enqueue(std::uint32_t first_sample, std::uint32_t samples);
    LiveCounts enqueue_round();
    void compact();
    bool copies_whole_paths() const;
    std::uint32_t capacity() const;
    void reserve_order(Arena& arena);

    Job& job_;
    IntegratorNeeds needs_;
    std::size_t real_bytes_, hit_bytes_;
    Batches batches_;
    bool reads_back_;  // the host reads the count of paths in play back after each compaction
    PinnedWords pinned_;
    Queue start_;  // the queue as it is when a batch starts
    PathBytes path_bytes_;
};

// Whether the host asks now and then if all paths of a batch have ended. It asks where no compaction reads the count
// back, and paths may be long enough that going on costs more than asking. A batch that is captured cannot ask.
inline bool asks_for_the_end(const Job& job, bool is_told, bool is_capturing, std::uint32_t segment) {
    constexpr std::uint32_t segments_between = 512;
    return !is_told && !is_capturing && job.longest_path > few_segments && segment % segments_between == 0;
}

}  // namespace pt::cuda
