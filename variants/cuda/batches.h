// The samples of a render in batches, as the integrators with a queue take them: by stream, or as a CUDA graph that is
// captured once, which may hold a loop over the segments.
#pragma once

#include <functional>
#include <memory>

#include "variants/cuda/job.h"
#include "variants/cuda/runtime/graph.h"

namespace pt::cuda {

class Batches {
public:
    // Enqueues the paths of `samples` samples of every pixel, from their first segment to their last.
    using Enqueue = std::function<void(std::uint32_t first_sample, std::uint32_t samples)>;

    Batches(Job& job, std::uint32_t samples_in_flight, const LaunchTraits& launch)
        : job_(job), samples_in_flight_(samples_in_flight), launch_(launch) {}

    void reserve(Arena& arena);
    void clear();
    // Captures a full batch as a CUDA graph before the clock starts, if the variant's launches are captured in one.
    void prepare(const Enqueue& enqueue);
    // Enqueues all samples of the job, samples_in_flight at a time. A batch that is not full (the last one, or the only
    // one of a short part of a render) fills the first slots of the queue only. Full batches run as a CUDA graph where
    // one was captured, others by stream.
    void run(const Enqueue& enqueue);

    // Captures the body of a graph's loop over segments, if the graph has one and a batch is being captured:
    // `enqueue_round` enqueues segments 1 and 2 and returns the counters of the paths then alive; the loop ends with
    // the last path. Returns how many segments the loop may take: all but the last possible one, which ends
    // differently.
    std::uint32_t enqueue_loop(const std::function<LiveCounts()>& enqueue_round);
    SegmentNumber segment(std::uint32_t number) const { return {number, is_in_loop_ ? offset_ : nullptr}; }
    // The device address of a batch's first sample while the batch is captured; null: kernels get the sample itself.
    const std::uint32_t* cursor() const { return is_capturing_ ? next_sample_ : nullptr; }
    bool is_capturing() const { return is_capturing_; }
    std::uint32_t samples_in_flight() const { return samples_in_flight_; }
    // The work in the rounds of graph loops so far, by the device's count of rounds. Waits for the device.
    WorkCounters loop_work() const;

private:
    void launch_graph(std::uint32_t sample);

    Job& job_;
    std::uint32_t samples_in_flight_;  // samples of each pixel in a full batch
    LaunchTraits launch_;
    std::unique_ptr<Graph> graph_;
    WorkCounters work_per_graph_;  // work that the host counts for one captured batch
    WorkCounters work_per_round_;  // work of one round of a CUDA graph's loop
    bool is_capturing_ = false;
    bool is_in_loop_ = false;               // the body of a CUDA graph's loop is now being captured
    std::uint32_t* next_sample_ = nullptr;  // device address of the first sample of the graph's next launch
    std::uint32_t graph_sample_ = 0;        // value of *next_sample_ once all enqueued work has run
    std::uint32_t* offset_ = nullptr;       // device: segments that a batch's loop took in earlier rounds; 0 outside
    std::uint64_t* rounds_ = nullptr;       // in device memory: rounds that graph loops have run since the render began
};

}  // namespace pt::cuda
