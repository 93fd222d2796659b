// What an integrator on CUDA is handed: the scene and the film on the device, compiled kernels, a stream, the samples
// to take, and the choices of the other axes.
#pragma once

#include <functional>
#include <memory>
#include <utility>

#include "variants/cuda/graph.h"
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

// A loop that a graph holds, as its kernels see it.
struct Loop {
    std::uint32_t* offset = nullptr;  // device: segments that earlier rounds of this batch took; 0 outside the loop
    std::uint64_t* rounds = nullptr;  // device: rounds run since the render began
    WorkCounters work_per_round;      // what the host's side of one round counts
};

struct Job {
    const Module* module = nullptr;
    ParameterBytes scene;  // SceneView<Real>, device pointers inside
    FilmView film;         // device pointers
    std::uint32_t pixels = 0;
    std::uint32_t longest_path = 1;  // segments
    std::uint32_t materials = 0;
    // The samples to take now, a pixel: the whole render's, or those of one part of it, from checkpoint to checkpoint.
    std::uint32_t first_sample = 0;
    std::uint32_t samples = 1;
    std::uint32_t samples_in_flight = 1;  // a pixel; a part may have fewer samples
    std::uint32_t block = 128;            // threads
    std::uint32_t multiprocessors = 1;
    cudaStream_t stream = nullptr;

    HitCache<float> cache;          // of Hit<Real>; rays 0: none
    std::uint32_t cached_rays = 0;  // of a pixel, that earlier parts of the render have put there
    Totals* totals = nullptr;
    HealthRequest health;  // for an integrator that inspects; counters: device
    SegmentCounts segments;
    std::uint64_t* lengths = nullptr;     // megakernels: paths by number of segments; null where nobody asked
    std::uint64_t* next_item = nullptr;   // for persistent threads
    std::uint32_t samples_per_piece = 1;  // likewise

    // For integrators with a queue.
    Queue queue;                       // in the state in which a batch starts
    Compaction* compaction = nullptr;  // null: none
    bool appends_in_kernel = false;    // the integrator's own kernel does what the compaction would
    Sorting* sorting = nullptr;        // null: none
    SortKeyTraits sort_key;
    KeyBounds key_bounds;
    std::uint32_t* append_counts = nullptr;  // where appends_in_kernel: append_counters for every segment
    std::uint32_t append_counters = 1;
    bool reads_back = false;                // the host learns the count after each compaction
    std::uint32_t* pinned_count = nullptr;  // host memory that the device can write, 64 words

    bool is_captured = false;
    std::unique_ptr<Graph> graph;
    bool loops = false;  // the graph holds a loop over the segments
    Loop loop;
    bool is_in_loop = false;                // its body is being captured
    std::uint32_t* next_sample = nullptr;   // device: where a graph finds its first sample
    std::uint32_t graph_sample = 0;         // what next_sample holds once all that was enqueued has run
    const std::uint32_t* cursor = nullptr;  // next_sample while a batch is captured, else null: use the parameter
    WorkCounters work_per_graph;            // what the host's side of one captured batch counts
    StageEvents* stages = nullptr;          // null: not instrumented
    WorkCounters work;

    SegmentNumber segment(std::uint32_t number) const { return {number, is_in_loop ? loop.offset : nullptr}; }

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

// Camera rays of a pixel that the job's samples use and that the cache does not hold yet; from here on it holds them.
std::uint32_t take_missing_rays(Job& job);
// Fills the first-bounce cache, if there is one, with those.
void fill_cache(Job& job);

// Samples of a pixel that one launch may take when its threads share them, so that a thread's and a block's counters
// fit in 32 bits.
std::uint32_t samples_per_launch(const Job& job);
// The same for persistent threads, which add up what they have counted after a piece: so many that the pieces' numbers
// fit in 32 bits.
std::uint32_t samples_per_persistent_launch(const Job& job);
// Samples of the strip of 32 pixels that is a piece: job.samples_per_piece, or fewer, so that a thread that happens to
// trace them all can count them in 32 bits.
std::uint32_t samples_per_strip(const Job& job);

// Runs `enqueue_batch(first_sample, samples)` for all samples of the job, samples_in_flight at a time. A last batch
// that is not full, and so every part of a render with fewer samples than that, takes the places of the first paths of
// the queue only. Full batches run as a graph where the job is captured, others by stream; prepare_batches must have
// run before the clock.
using EnqueueBatch = std::function<void(std::uint32_t first_sample, std::uint32_t samples)>;
void prepare_batches(Job& job, const EnqueueBatch& enqueue_batch);
void run_batches(Job& job, const EnqueueBatch& enqueue_batch);

// Where the job loops and a batch is being captured: captures `enqueue_round`, which enqueues segments 1 and 2 and
// returns where the paths then alive are counted, as a loop that ends with the last path. Returns the number of
// segments that the loop may take: none of them is the last possible one, which ends differently.
std::uint32_t enqueue_loop(Job& job, const std::function<LiveCounts()>& enqueue_round);

}  // namespace pt::cuda
