// Encodes a binary tree as a cwbvh on the GPU in two phases: a bottom-up pass computes the optimal cuts (the second
// child to arrive continues with the parent), then wide nodes are emitted from the root down, one kernel launch per
// level.
#include "harness/rays/cwbvh_encoder.h"

#include <stdexcept>
#include <string>

#include <cuda_runtime.h>

#include "variants/accelerator/cwbvh_encode.h"
#include "variants/cuda/device/warp_reduce.cuh"

namespace pt::accelerator::cwbvh {
namespace {

constexpr std::uint32_t block = 128;
using cuda::all_lanes;

void check(cudaError_t error) {
    if (error != cudaSuccess) {
        throw std::runtime_error(std::string("encoding a tree on the GPU: ") + cudaGetErrorString(error));
    }
}

template <class T>
class Memory {
public:
    explicit Memory(std::size_t size) : bytes_((size == 0 ? 1 : size) * sizeof(T)) {
        check(cudaMalloc(&data_, bytes_));
    }
    Memory(const Memory&) = delete;
    Memory& operator=(const Memory&) = delete;
    ~Memory() { cudaFree(data_); }
    T* data() const { return data_; }
    void clear() const { check(cudaMemsetAsync(data_, 0, bytes_)); }

private:
    T* data_ = nullptr;
    std::size_t bytes_;
};

struct EncoderView {
    std::uint32_t count;
    const GpuNode* nodes;
    const std::uint32_t* root;
    std::uint32_t* parents;
    std::uint32_t* arrived;  // number of a node's children whose optimal cuts are computed, by inner node
    Cut* cuts;               // optimal cuts of the subtrees, by inner node
    std::uint32_t* tasks;    // index of the binary node that each wide node encodes
    Node* wide;
    std::uint32_t* references;
    std::uint32_t* level_counts;  // number of wide nodes by level
    std::uint32_t* slot_count;

    __device__ bool is_leaf(std::uint32_t node) const { return node < count; }
    __device__ std::uint32_t left(std::uint32_t node) const { return nodes[node].left; }
    __device__ std::uint32_t right(std::uint32_t node) const { return nodes[node].right; }
    __device__ Box box(std::uint32_t node) const {
        const float4* words = reinterpret_cast<const float4*>(nodes + node);
        const float4 low = words[0], high = words[1];
        return {{low.x, low.y, low.z}, {high.x, high.y, high.z}};
    }
    // Reads a node's cut past the L1 cache (__ldcg), because other multiprocessors write cuts during this kernel.
    __device__ Cut cut(std::uint32_t node) const {
        if (is_leaf(node)) {
            return Cut::of_leaf(box_area(box(node)), 1);
        }
        const float4* words = reinterpret_cast<const float4*>(cuts + (node - count));
        const float4 a = __ldcg(words), b = __ldcg(words + 1);
        return {{a.x, a.y, a.z, a.w, b.x, b.y, b.z}, __float_as_uint(b.w)};
    }
    __device__ void store(std::uint32_t node, const Cut& cut) const {
        float4* words = reinterpret_cast<float4*>(cuts + (node - count));
        words[0] = make_float4(cut.cost[0], cut.cost[1], cut.cost[2], cut.cost[3]);
        words[1] = make_float4(cut.cost[4], cut.cost[5], cut.cost[6], __uint_as_float(cut.choices));
    }
};

__global__ void link_parents(const __grid_constant__ EncoderView view) {
    const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
    if (i + 1 < view.count) {
        const GpuNode node = view.nodes[view.count + i];
        view.parents[node.left] = view.parents[node.right] = view.count + i;
    }
}

__global__ void __launch_bounds__(block) cut_upwards(const __grid_constant__ EncoderView view) {
    const std::uint32_t leaf = blockIdx.x * blockDim.x + threadIdx.x, root = *view.root;
    if (leaf >= view.count) {
        return;
    }
    for (std::uint32_t node = leaf; node != root;) {
        node = view.parents[node];
        __threadfence();
        if (atomicAdd(view.arrived + (node - view.count), 1u) == 0) {
            return;
        }
        __threadfence();
        view.store(node,
                   Cut::of_inner(box_area(view.box(node)), view.cut(view.left(node)), view.cut(view.right(node))));
    }
}

__global__ void start_at_root(const __grid_constant__ EncoderView view) {
    view.tasks[0] = *view.root;
    view.level_counts[0] = 1;
}

// Reserves `amount` elements from a global counter for each lane, with a warp-wide prefix sum and one atomic per warp.
__device__ std::uint32_t allocate(std::uint32_t* counter, std::uint32_t amount) {
    const std::uint32_t lane = threadIdx.x & 31u;
    std::uint32_t sum = amount;
    for (int distance = 1; distance < 32; distance *= 2) {
        const std::uint32_t before = __shfl_up_sync(all_lanes, sum, distance);
        sum += lane >= static_cast<std::uint32_t>(distance) ? before : 0u;
    }
    std::uint32_t base = 0;
    if (lane == 31) {
        base = atomicAdd(counter, sum);
    }
    return __shfl_sync(all_lanes, base, 31) + sum - amount;
}

__device__ std::uint32_t write_references(const EncoderView& view, std::uint32_t node, std::uint32_t slot) {
    std::uint32_t open[largest_leaf], depth = 0;
    open[depth++] = node;
    while (depth != 0) {
        const std::uint32_t next = open[--depth];
        if (view.is_leaf(next)) {
            view.references[slot++] = view.nodes[next].left;
        } else {
            open[depth++] = view.right(next);
            open[depth++] = view.left(next);
        }
    }
    return slot;
}

__global__ void __launch_bounds__(block) expand(const __grid_constant__ EncoderView view, std::uint32_t level) {
    std::uint32_t begin = 0;
    for (std::uint32_t i = 0; i < level; ++i) {
        begin += view.level_counts[i];
    }
    const std::uint32_t count = view.level_counts[level];
    for (std::uint32_t first = blockIdx.x * blockDim.x; first < count; first += gridDim.x * blockDim.x) {
        const std::uint32_t i = first + threadIdx.x;
        std::uint32_t at[width];
        Node node{};
        if (i < count) {
            const std::uint32_t binary = view.tasks[begin + i];
            Children children;
            if (level == 0 && view.cut(binary).is_leaf()) {
                children.node[children.count++] = binary;
            } else {
                children = Children::of(view, binary);
            }
            children.put_at_corners(view, view.box(binary), at);
            node = make_node(view, view.box(binary), at);
        }
        node.child_base = begin + count + allocate(view.level_counts + level + 1, bits_in(node.contents >> 24));
        node.slot_base = allocate(view.slot_count, bits_in(node.contents & 0xffffffu));
        if (i < count) {
            std::uint32_t child = node.child_base, slot = node.slot_base;
            for (std::uint32_t corner = 0; corner < width; ++corner) {
                if ((node.contents >> (24 + corner) & 1u) != 0) {
                    view.tasks[child++] = at[corner];
                } else if ((node.contents >> (3 * corner) & 1u) != 0) {
                    slot = write_references(view, at[corner], slot);
                }
            }
            view.wide[begin + i] = node;
        }
    }
}

}  // namespace

struct GpuEncoderMemory {
    explicit GpuEncoderMemory(std::uint32_t primitives)
        : count(primitives),
          parents(2 * static_cast<std::size_t>(primitives)),
          arrived(primitives),
          cuts(primitives),
          tasks(primitives),
          wide(primitives),
          references(primitives),
          counters(largest_depth + 2) {}

    std::uint32_t count;
    Memory<std::uint32_t> parents, arrived;
    Memory<Cut> cuts;
    Memory<std::uint32_t> tasks;
    Memory<Node> wide;
    Memory<std::uint32_t> references;
    Memory<std::uint32_t> counters;  // number of leaf slots, then the number of wide nodes in each level
};

GpuEncoder::GpuEncoder(std::uint32_t primitives) : memory_(std::make_unique<GpuEncoderMemory>(primitives)) {}
GpuEncoder::~GpuEncoder() = default;

void GpuEncoder::encode(const GpuNode* nodes, const std::uint32_t* root) {
    const GpuEncoderMemory& m = *memory_;
    const EncoderView view{m.count,          nodes,          root,          m.parents.data(),    m.arrived.data(),
                           m.cuts.data(),    m.tasks.data(), m.wide.data(), m.references.data(), m.counters.data() + 1,
                           m.counters.data()};
    m.arrived.clear();
    m.counters.clear();
    if (m.count == 0) {
        return;
    }
    const std::uint32_t blocks = (m.count + block - 1) / block;
    link_parents<<<blocks, block>>>(view);
    cut_upwards<<<blocks, block>>>(view);
    start_at_root<<<1, 1>>>(view);
    for (std::uint32_t level = 0; level < largest_depth; ++level) {
        expand<<<1056, block>>>(view, level);
    }
    check(cudaGetLastError());
}

std::uint32_t GpuEncoder::node_count() const {
    std::uint32_t counters[largest_depth + 2];
    check(cudaMemcpy(counters, memory_->counters.data(), sizeof counters, cudaMemcpyDeviceToHost));
    if (counters[largest_depth + 1] != 0) {
        throw std::length_error("cwbvh: the tree is deeper than 64 nodes of 8 children");
    }
    std::uint32_t count = 0;
    for (std::uint32_t level = 0; level < largest_depth; ++level) {
        count += counters[level + 1];
    }
    return count;
}
const Node* GpuEncoder::device_nodes() const { return memory_->wide.data(); }
const std::uint32_t* GpuEncoder::device_references() const { return memory_->references.data(); }

}  // namespace pt::accelerator::cwbvh
