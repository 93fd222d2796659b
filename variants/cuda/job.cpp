#include "variants/cuda/job.h"

#include <algorithm>

#include "variants/cuda/queue_kernels.h"

namespace pt::cuda {

// Sample s uses ray s mod rays: a render's first samples need a ray each, and none that follow them need another.
std::uint32_t take_missing_rays(Job& job) {
    const std::uint32_t missing = std::min(job.cache.rays - job.cached_rays, job.samples);
    job.cached_rays += missing;
    return missing;
}

void fill_cache(Job& job) {
    const std::uint32_t missing = take_missing_rays(job);
    if (missing == 0) {
        return;
    }
    const Stage stage(job.stages, "fill cache", job.stream);
    job.launch("fill_cache", job.pixels, job.scene, job.cache, job.first_sample, missing, job.totals);
}

std::uint32_t samples_per_launch(const Job& job) {
    const std::uint64_t rays_per_sample = 2ull * job.longest_path;  // a segment and, at most, a connection
    const std::uint64_t a_thread = std::max<std::uint64_t>(1, 0xffffffffull / (rays_per_sample * job.block));
    const std::uint64_t threads_per_pixel = std::min(job.samples_in_flight, job.samples);
    return static_cast<std::uint32_t>(std::clamp<std::uint64_t>(a_thread * threads_per_pixel, 1, job.samples));
}

std::uint32_t samples_per_persistent_launch(const Job& job) {
    const std::uint64_t by_pieces = 0xffffffffull / ((job.pixels + 31) / 32) - 1;
    return static_cast<std::uint32_t>(std::clamp<std::uint64_t>(by_pieces, 1, job.samples));
}

std::uint32_t samples_per_strip(const Job& job) {
    const std::uint64_t rays_per_sample = 32ull * 2 * job.longest_path;
    const std::uint64_t countable = (0xffffffffull - few_rays) / rays_per_sample;
    return static_cast<std::uint32_t>(std::clamp<std::uint64_t>(countable, 1, job.samples_per_piece));
}

void prepare_batches(Job& job, const EnqueueBatch& enqueue_batch) {
    if (!job.is_captured || job.stages != nullptr) {  // events that time stages cannot be captured
        return;
    }
    PT_CUDA_CHECK(cudaMemcpyAsync(job.next_sample, &job.first_sample, sizeof job.first_sample, cudaMemcpyHostToDevice,
                                  job.stream));
    PT_CUDA_CHECK(cudaStreamSynchronize(job.stream));
    job.graph_sample = job.first_sample;
    job.graph = std::make_unique<Graph>(job.stream);
    const WorkCounters before = std::exchange(job.work, {});
    job.cursor = job.next_sample;
    job.graph->capture([&] {
        enqueue_batch(job.first_sample, job.samples_in_flight);
        job.launch_blocks("advance", 1, job.next_sample, job.samples_in_flight);
    });
    job.cursor = nullptr;
    job.work_per_graph = std::exchange(job.work, before);
    job.work_per_graph.launches = 1;
    job.work_per_graph.graph_nodes = job.graph->nodes();
}

namespace {

// A graph goes on where the last one ended; batches that ran by stream in between have to be skipped.
void launch_graph(Job& job, std::uint32_t sample) {
    if (job.graph_sample != sample) {
        set_value(job.next_sample, sample, job.stream);
        job.work.launches += 1;
    }
    job.graph->launch();
    job.work += job.work_per_graph;
    job.graph_sample = sample + job.samples_in_flight;
}

}  // namespace

void run_batches(Job& job, const EnqueueBatch& enqueue_batch) {
    fill_cache(job);
    for (std::uint32_t done = 0; done < job.samples;) {
        const std::uint32_t batch = std::min(job.samples_in_flight, job.samples - done);
        if (job.graph != nullptr && batch == job.samples_in_flight) {
            launch_graph(job, job.first_sample + done);
        } else {
            enqueue_batch(job.first_sample + done, batch);
        }
        done += batch;
    }
}

std::uint32_t enqueue_loop(Job& job, const std::function<LiveCounts()>& enqueue_round) {
    const bool captures = job.cursor != nullptr;
    if (!job.loops || !captures || job.longest_path < segments_per_round + 2) {
        return 0;
    }
    const std::uint32_t taken = (job.longest_path - 2) / segments_per_round * segments_per_round;
    const WorkCounters before = std::exchange(job.work, {});
    job.is_in_loop = true;
    job.graph->capture_loop([&](cudaGraphConditionalHandle condition) {
        const LiveCounts live = enqueue_round();
        end_round(condition, live, job.loop.offset, taken, job.loop.rounds, job.stream);
    });
    job.is_in_loop = false;
    job.loop.work_per_round = std::exchange(job.work, before);
    job.loop.work_per_round.launches = 0;  // the device's own
    return taken;
}

}  // namespace pt::cuda
