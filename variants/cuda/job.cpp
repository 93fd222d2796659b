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

void Graph::capture(cudaStream_t stream, cudaKernel_t kernel, int sample_parameter,
                    const std::function<void()>& enqueue) {
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
    std::vector<cudaGraphNode_t> nodes(nodes_);
    PT_CUDA_CHECK(cudaGraphGetNodes(graph_, nodes.data(), &nodes_));
    for (cudaGraphNode_t node : nodes) {
        cudaGraphNodeType type{};
        PT_CUDA_CHECK(cudaGraphNodeGetType(node, &type));
        cudaKernelNodeParams parameters{};
        if (type == cudaGraphNodeTypeKernel && cudaGraphKernelNodeGetParams(node, &parameters) == cudaSuccess &&
            parameters.func == static_cast<void*>(kernel)) {
            sample_node_ = node;
            parameters_ = parameters;
        }
    }
    (void)cudaGetLastError();
    if (sample_node_ == nullptr) {
        throw Error("the captured graph lacks the kernel that takes the first sample");
    }
    sample_parameter_ = sample_parameter;
    PT_CUDA_CHECK(cudaGraphInstantiate(&executable_, graph_, 0));
}

void Graph::launch(cudaStream_t stream, std::uint32_t first_sample) {
    // The node's parameters are the graph's own copies; the executable graph copies them again.
    *static_cast<std::uint32_t*>(parameters_.kernelParams[sample_parameter_]) = first_sample;
    PT_CUDA_CHECK(cudaGraphExecKernelNodeSetParams(executable_, sample_node_, &parameters_));
    PT_CUDA_CHECK(cudaGraphLaunch(executable_, stream));
}

void fill_cache(Job& job) {
    if (job.cache.rays == 0) {
        return;
    }
    const Stage stage(job.stages, "fill cache", job.stream);
    // Sample s uses ray s mod rays: a short render that starts at sample 0 needs the first ones only.
    const std::uint32_t used =
        job.first_sample == 0 ? std::min(job.cache.rays, job.samples) : job.cache.rays;
    job.launch("fill_cache", job.pixels, job.scene, job.cache, used, job.totals);
}

std::uint32_t samples_a_launch(const Job& job) {
    const std::uint64_t rays_a_sample = 2ull * job.longest_path;  // a segment and, at most, a connection
    const std::uint64_t most = 0xffffffffull / (rays_a_sample * job.block);
    return static_cast<std::uint32_t>(std::clamp<std::uint64_t>(most, 1, job.samples));
}

void prepare_batches(Job& job, const char* first_kernel, int sample_parameter, const EnqueueBatch& enqueue_batch) {
    if (!job.is_captured || job.stages != nullptr || job.samples < job.samples_in_flight) {
        return;
    }
    job.graph = std::make_unique<Graph>();
    const WorkCounters before = std::exchange(job.work, {});
    job.graph->capture(job.stream, job.module->kernel(first_kernel), sample_parameter,
                       [&] { enqueue_batch(job.first_sample, job.samples_in_flight); });
    job.work_a_graph = std::exchange(job.work, before);
    job.work_a_graph.launches = 1;
    job.work_a_graph.graph_nodes = job.graph->nodes();
}

void run_batches(Job& job, const EnqueueBatch& enqueue_batch) {
    fill_cache(job);
    for (std::uint32_t done = 0; done < job.samples;) {
        const std::uint32_t batch = std::min(job.samples_in_flight, job.samples - done);
        if (job.graph != nullptr && batch == job.samples_in_flight) {
            job.graph->launch(job.stream, job.first_sample + done);
            job.work += job.work_a_graph;
        } else {
            enqueue_batch(job.first_sample + done, batch);
        }
        done += batch;
    }
}

}  // namespace pt::cuda
