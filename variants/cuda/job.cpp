#include "variants/cuda/job.h"

#include <algorithm>

namespace pt::cuda {

Graph::~Graph() {
    if (executable_ != nullptr) {
        (void)cudaGraphExecDestroy(executable_);
    }
    if (graph_ != nullptr) {
        (void)cudaGraphDestroy(graph_);
    }
}

void Graph::capture(cudaStream_t stream, const std::function<void()>& enqueue) {
    // Relaxed: kernels that are launched for the first time may load meanwhile.
    PT_CUDA_CHECK(cudaStreamBeginCapture(stream, cudaStreamCaptureModeRelaxed));
    try {
        enqueue();
    } catch (...) {
        (void)cudaStreamEndCapture(stream, &graph_);
        throw;
    }
    PT_CUDA_CHECK(cudaStreamEndCapture(stream, &graph_));
    PT_CUDA_CHECK(cudaGraphGetNodes(graph_, nullptr, &nodes_));
    PT_CUDA_CHECK(cudaGraphInstantiate(&executable_, graph_, 0));
}

void Graph::launch(cudaStream_t stream) const { PT_CUDA_CHECK(cudaGraphLaunch(executable_, stream)); }

void fill_cache(Job& job) {
    if (job.cache.rays == 0) {
        return;
    }
    const Stage stage(job.stages, "fill cache", job.stream);
    // Sample s uses ray s mod rays: a short render needs a few of them only.
    const std::uint32_t used = std::min(job.cache.rays, job.samples);
    job.launch("fill_cache", job.pixels, job.scene, job.cache, job.first_sample, used, job.totals);
}

std::uint32_t samples_a_launch(const Job& job) {
    const std::uint64_t rays_a_sample = 2ull * job.longest_path;  // a segment and, at most, a connection
    const std::uint64_t most = 0xffffffffull / (rays_a_sample * job.block);
    return static_cast<std::uint32_t>(std::clamp<std::uint64_t>(most, 1, job.samples));
}

void prepare_batches(Job& job, const EnqueueBatch& enqueue_batch) {
    if (!job.is_captured || job.stages != nullptr) {  // events that time stages cannot be captured
        return;
    }
    PT_CUDA_CHECK(cudaMemcpyAsync(job.next_sample, &job.first_sample, sizeof job.first_sample, cudaMemcpyHostToDevice,
                                  job.stream));
    PT_CUDA_CHECK(cudaStreamSynchronize(job.stream));
    job.graph = std::make_unique<Graph>();
    const WorkCounters before = std::exchange(job.work, {});
    job.cursor = job.next_sample;
    job.graph->capture(job.stream, [&] {
        enqueue_batch(job.first_sample, job.samples_in_flight);
        job.launch_blocks("advance", 1, job.next_sample, job.samples_in_flight);
    });
    job.cursor = nullptr;
    job.work_a_graph = std::exchange(job.work, before);
    job.work_a_graph.launches = 1;
    job.work_a_graph.graph_nodes = job.graph->nodes();
}

void run_batches(Job& job, const EnqueueBatch& enqueue_batch) {
    fill_cache(job);
    for (std::uint32_t done = 0; done < job.samples;) {
        const std::uint32_t batch = std::min(job.samples_in_flight, job.samples - done);
        if (job.graph != nullptr && batch == job.samples_in_flight) {
            job.graph->launch(job.stream);
            job.work += job.work_a_graph;
        } else {
            enqueue_batch(job.first_sample + done, batch);
        }
        done += batch;
    }
}

}  // namespace pt::cuda
