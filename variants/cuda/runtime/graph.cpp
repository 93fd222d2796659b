#include "variants/cuda/runtime/graph.h"

#include <stdexcept>
#include <vector>

namespace pt::cuda {

namespace {

std::size_t node_count(cudaGraph_t graph) {
    std::size_t count = 0;
    PT_CUDA_CHECK(cudaGraphGetNodes(graph, nullptr, &count));
    return count;
}

// Adds a node to a CUDA graph by cudaGraphAddNode, a name that CUDA 13 gave to the function with edge data.
cudaError_t add_node(cudaGraphNode_t* node, cudaGraph_t graph, const std::vector<cudaGraphNode_t>& after,
                     cudaGraphNodeParams* parameters) {
#if CUDART_VERSION >= 13000
    return cudaGraphAddNode(node, graph, after.data(), nullptr, after.size(), parameters);
#else
    return cudaGraphAddNode(node, graph, after.data(), after.size(), parameters);
#endif
}

// The graph nodes on which the next work put on a stream under capture will depend.
std::vector<cudaGraphNode_t> last_nodes(cudaStream_t stream) {
    cudaStreamCaptureStatus status = cudaStreamCaptureStatusNone;
    const cudaGraphNode_t* nodes = nullptr;
    std::size_t count = 0;
#if CUDART_VERSION >= 13000
    PT_CUDA_CHECK(cudaStreamGetCaptureInfo(stream, &status, nullptr, nullptr, &nodes, nullptr, &count));
#else
    PT_CUDA_CHECK(cudaStreamGetCaptureInfo_v2(stream, &status, nullptr, nullptr, &nodes, &count));
#endif
    if (status != cudaStreamCaptureStatusActive) {
        throw std::logic_error("a loop outside a capture");
    }
    return {nodes, nodes + count};
}

}  // namespace

Graph::~Graph() {
    if (executable_ != nullptr) {
        (void)cudaGraphExecDestroy(executable_);
    }
    if (graph_ != nullptr) {
        (void)cudaGraphDestroy(graph_);
    }
}

void Graph::begin(cudaGraph_t target, const cudaGraphNode_t* after) {
    // Capture is relaxed, since kernels that are launched for the first time may load meanwhile.
    PT_CUDA_CHECK(cudaStreamBeginCaptureToGraph(stream_, target, after, nullptr, after != nullptr ? 1 : 0,
                                                cudaStreamCaptureModeRelaxed));
}

void Graph::end(cudaGraph_t target) {
    cudaGraph_t captured = nullptr;
    PT_CUDA_CHECK(cudaStreamEndCapture(stream_, &captured));
    if (captured != target) {
        throw std::logic_error("a capture ended in another graph than it began in");
    }
}

void Graph::capture(const std::function<void()>& enqueue) {
    PT_CUDA_CHECK(cudaGraphCreate(&graph_, 0));
    begin(graph_, nullptr);
    try {
        enqueue();
    } catch (...) {
        cudaGraph_t captured = nullptr;
        (void)cudaStreamEndCapture(stream_, &captured);
        throw;
    }
    end(graph_);
    nodes_ += node_count(graph_);
    PT_CUDA_CHECK(cudaGraphInstantiate(&executable_, graph_, 0));
}

void Graph::capture_loop(const std::function<void(cudaGraphConditionalHandle condition)>& enqueue_body) {
    const std::vector<cudaGraphNode_t> before = last_nodes(stream_);
    end(graph_);
    cudaGraphNodeParams parameters{};
    parameters.type = cudaGraphNodeTypeConditional;
    parameters.conditional.type = cudaGraphCondTypeWhile;
    parameters.conditional.size = 1;
    PT_CUDA_CHECK(
        cudaGraphConditionalHandleCreate(&parameters.conditional.handle, graph_, 1, cudaGraphCondAssignDefault));
    cudaGraphNode_t loop = nullptr;
    PT_CUDA_CHECK(add_node(&loop, graph_, before, &parameters));
    cudaGraph_t const body = parameters.conditional.phGraph_out[0];
    begin(body, nullptr);
    enqueue_body(parameters.conditional.handle);
    end(body);
    nodes_ += node_count(body);
    begin(graph_, &loop);
}

void Graph::launch() const { PT_CUDA_CHECK(cudaGraphLaunch(executable_, stream_)); }

}  // namespace pt::cuda
