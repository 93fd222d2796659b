// What an integrator on CUDA is handed: the scene and the film on the device, compiled kernels, a stream, the samples
// to take, and the choices of the other axes.
#pragma once

#include <functional>
#include <memory>
#include <utility>

#include "variants/cuda/stage_events.h"
#include "variants/cuda/stages.h"
#include "variants/cuda/totals.h"
#include "variants/descriptor.h"

namespace pt::cuda {

// Maps positions to [0, 1)^3 for Morton codes: (position - low) * inverse_extent, clamped by who uses it.
struct KeyBounds {
    float low[3] = {0, 0, 0};
    float inverse_extent[3] = {1, 1, 1};
};

// A captured batch of samples. Its kernels read the first sample from device memory, and its last one moves it on.
class Graph {
public:
    Graph() = default;
    ~Graph();
    Graph(const Graph&) = delete;
    Graph& operator=(const Graph&) = delete;

    // Records what `enqueue` puts on the stream.
    void capture(cudaStream_t stream, const std::function<void()>& enqueue);
    void launch(cudaStream_t stream) const;
    std::size_t nodes() const { return nodes_; }

private:
    cudaGraph_t graph_ = nullptr;
    cudaGraphExec_t executable_ = nullptr;
    std::size_t nodes_ = 0;
};

struct Job {
    const Module* module = nullptr;
    ParameterBytes scene;  // SceneView<Real>, device pointers inside
    FilmView film;         // device pointers
    std::uint32_t pixels = 0;
    std::uint32_t longest_path = 1;  // segments
    std::uint32_t materials = 0;
    std::uint32_t first_sample = 0;
    std::uint32_t samples = 1;            // a pixel
    std::uint32_t samples_in_flight = 1;  // a pixel
    std::uint32_t block = 128;            // threads
    std::uint32_t multiprocessors = 1;
    cudaStream_t stream = nullptr;

    HitCache<float> cache;  // of Hit<Real>; rays 0: none
    Totals* totals = nullptr;
    SegmentCounts segments;
    std::uint64_t* lengths = nullptr;    // megakernels: paths by number of segments; null where nobody asked
    std::uint64_t* next_item = nullptr;  // for persistent threads

    // For integrators with a queue.
    Queue queue;                       // in the state in which a batch starts
    Compaction* compaction = nullptr;  // null: none
    bool appends_in_kernel = false;    // the integrator's own kernel does what the compaction would
    Sorting* sorting = nullptr;        // null: none
    SortKey sort_key;
    KeyBounds key_bounds;
    std::uint32_t* append_counts = nullptr;  // where appends_in_kernel: append_counters for every segment
    std::uint32_t append_counters = 1;
    bool reads_back = false;                // the host learns the count after each compaction
    std::uint32_t* pinned_count = nullptr;  // host memory that the device can write, 64 words

    bool is_captured = false;
    std::unique_ptr<Graph> graph;
    std::uint32_t* next_sample = nullptr;   // device: where a graph finds its first sample
    const std::uint32_t* cursor = nullptr;  // next_sample while a batch is captured, else null: use the parameter
    WorkCounters work_a_graph;              // what the host's side of one captured batch counts
    StageEvents* stages = nullptr;          // null: not instrumented
    WorkCounters work;

    template <class... Parameters>
    void launch(const char* kernel, std::uint32_t threads, const Parameters&... parameters) {
        launch_blocks(kernel, (threads + block - 1) / block, parameters...);
    }
    template <class... Parameters>
    void launch_blocks(const char* kernel, std::uint32_t blocks, const Parameters&... parameters) {
        if (blocks != 0) {
            module->launch(kernel, blocks, block, stream, parameters...);
            work.launches += 1;
        }
    }
};

// Fills the first-bounce cache, if there is one, with the camera rays that the job's samples use.
void fill_cache(Job& job);

// Samples that one launch of a kernel may take a thread, so that a thread's and a block's counters fit in 32 bits.
std::uint32_t samples_a_launch(const Job& job);

// Runs `enqueue_batch(first_sample, samples)` for all samples of the job, samples_in_flight at a time; full batches as
// a graph where the job is captured. prepare_batches must have run before the clock.
using EnqueueBatch = std::function<void(std::uint32_t first_sample, std::uint32_t samples)>;
void prepare_batches(Job& job, const EnqueueBatch& enqueue_batch);
void run_batches(Job& job, const EnqueueBatch& enqueue_batch);

}  // namespace pt::cuda
