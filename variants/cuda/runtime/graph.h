// A captured batch of samples as a CUDA graph, and the loop that a graph may hold: a conditional node whose body, two
// segments of every path, runs again as long as paths live (CUDA 12.4's while node).
#pragma once

#include <cstdint>
#include <functional>

#include "variants/cuda/runtime/check.h"

namespace pt::cuda {

// Segments of a path in one round of a graph's loop: an even number, so that buffers swapped by segments are back.
inline constexpr std::uint32_t segments_per_round = 2;

// Counters of live paths in device memory: `parts` of them, `stride` words apart; those of the next segment lie
// `segment_stride` words further on.
struct LiveCounts {
    const std::uint32_t* counts = nullptr;
    std::uint32_t parts = 1;
    std::uint32_t stride = 0;
    std::uint32_t segment_stride = 0;
};

// A CUDA graph captured from a stream. The graph's kernels read the first sample from device memory, and the last one
// advances it.
class Graph {
public:
    explicit Graph(cudaStream_t stream) : stream_(stream) {}
    ~Graph();
    Graph(const Graph&) = delete;
    Graph& operator=(const Graph&) = delete;

    // Captures the work that `enqueue` puts on the stream into a graph, and makes the graph ready to be launched.
    void capture(const std::function<void()>& enqueue);
    // Records, within capture, what `enqueue_body` puts on the stream as the body of a loop. The loop runs once, and
    // again until the body's last kernel, which `enqueue_body` is to put there, sets the condition to 0.
    void capture_loop(const std::function<void(cudaGraphConditionalHandle condition)>& enqueue_body);
    void launch() const;
    // Number of nodes of the graph; nodes in a loop's body count once.
    std::size_t nodes() const { return nodes_; }

private:
    void begin(cudaGraph_t target, const cudaGraphNode_t* after);
    // Ends the stream's capture into the graph `target`.
    void end(cudaGraph_t target);

    cudaStream_t stream_;
    cudaGraph_t graph_ = nullptr;
    cudaGraphExec_t executable_ = nullptr;
    std::size_t nodes_ = 0;
};

}  // namespace pt::cuda
