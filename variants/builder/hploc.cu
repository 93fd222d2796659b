// The builders LBVH and H-PLOC on the GPU. A tree is the same on every run: keys are sorted by (Morton code,
// primitive), merges depend on the boxes of a range alone, and a node's number follows from the leaves that it joins.
#include "variants/builder/hploc.h"

#include <stdexcept>
#include <string>
#include <vector>

#include <cuda_runtime.h>
#include <cub/device/device_radix_sort.cuh>

#include "variants/cuda/device/warp_reduce.cuh"

namespace pt::builder {
namespace {

constexpr std::uint32_t none = ~0u, block = 128;
constexpr std::uint32_t merge_to = 16;  // most clusters of nodes that a range of leaves keeps on its way up the tree
constexpr int search_radius = 8;
using cuda::all_lanes;

void check(cudaError_t error) {
    if (error != cudaSuccess) {
        throw std::runtime_error(std::string("building a tree on the GPU: ") + cudaGetErrorString(error));
    }
}

template <class T>
class Memory {
public:
    explicit Memory(std::size_t size) { check(cudaMalloc(&data_, (size == 0 ? 1 : size) * sizeof(T))); }
    Memory(const Memory&) = delete;
    Memory& operator=(const Memory&) = delete;
    ~Memory() { cudaFree(data_); }
    T* data() const { return data_; }

private:
    T* data_ = nullptr;
};

// A cluster in a range of leaves: the number of its node, and of the first of its leaves.
struct alignas(8) Cluster {
    std::uint32_t node, first;
};

// Maps floats to integers in the same order, for atomic minima and maxima.
__device__ int ordered(float x) {
    const int bits = __float_as_int(x);
    return bits >= 0 ? bits : bits ^ 0x7fffffff;
}
__device__ float from_ordered(int x) { return __int_as_float(x >= 0 ? x : x ^ 0x7fffffff); }

struct CentreBounds {
    int low[3], high[3];
};

__global__ void clear_bounds(CentreBounds* bounds) {
    if (threadIdx.x < 3) {
        bounds->low[threadIdx.x] = 0x7fffffff;
        bounds->high[threadIdx.x] = static_cast<int>(0x80000000u);
    }
}

// Twice the coordinate of a box's centre along an axis; the factor 2 cancels in every use.
__device__ float centre_of(const Box& box, int axis) { return box.low[axis] + box.high[axis]; }

__global__ void bound_centres(const Box* boxes, std::uint32_t count, CentreBounds* bounds) {
    int low[3] = {0x7fffffff, 0x7fffffff, 0x7fffffff};
    int high[3] = {-0x7fffffff - 1, -0x7fffffff - 1, -0x7fffffff - 1};
    for (std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x; i < count; i += gridDim.x * blockDim.x) {
        const Box box = boxes[i];
        for (int k = 0; k < 3; ++k) {
            const int centre = ordered(centre_of(box, k));
            low[k] = min(low[k], centre);
            high[k] = max(high[k], centre);
        }
    }
    for (int k = 0; k < 3; ++k) {
        const int warp_low = cuda::warp_min(low[k]), warp_high = cuda::warp_max(high[k]);
        if ((threadIdx.x & 31u) == 0) {
            atomicMin(&bounds->low[k], warp_low);
            atomicMax(&bounds->high[k], warp_high);
        }
    }
}

// Spreads the bits of a number of 21 bits three apart, for a Morton code.
__device__ std::uint64_t spread(std::uint64_t x) {
    x = (x | x << 32) & 0x1f00000000ffffull;
    x = (x | x << 16) & 0x1f0000ff0000ffull;
    x = (x | x << 8) & 0x100f00f00f00f00full;
    x = (x | x << 4) & 0x10c30c30c30c30c3ull;
    return (x | x << 2) & 0x1249249249249249ull;
}

// Computes the Morton codes of the boxes' centres. One cell size serves all axes, so that cells are cubes.
__global__ void morton_codes(const Box* boxes, std::uint32_t count, const CentreBounds* bounds, std::uint64_t* codes,
                             std::uint32_t* primitives) {
    const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
    if (i >= count) {
        return;
    }
    float extent = 0.0f;
    for (int k = 0; k < 3; ++k) {
        extent = fmaxf(extent, from_ordered(bounds->high[k]) - from_ordered(bounds->low[k]));
    }
    const Box box = boxes[i];
    std::uint64_t code = 0;
    for (int k = 0; k < 3; ++k) {
        const float along = extent > 0.0f ? (centre_of(box, k) - from_ordered(bounds->low[k])) / extent : 0.0f;
        code |= spread(static_cast<std::uint64_t>(fminf(along * 2097152.0f, 2097151.0f))) << k;
    }
    codes[i] = code;
    primitives[i] = i;
}

__global__ void make_leaves(const Box* boxes, const std::uint32_t* primitives, std::uint32_t count, GpuNode* nodes,
                            Cluster* clusters, std::uint32_t* other_end) {
    const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
    if (i >= count) {
        return;
    }
    const std::uint32_t primitive = primitives[i];
    const Box box = boxes[primitive];
    nodes[i] = {{box.low[0], box.low[1], box.low[2]}, primitive, {box.high[0], box.high[1], box.high[2]}, none};
    clusters[i] = {i, i};
    other_end[i] = none;
}

struct BuildView {
    std::uint32_t count;
    const std::uint64_t* codes;
    GpuNode* nodes;
    Cluster* clusters;
    std::uint32_t* other_end;  // entry i: of the two ranges that meet behind leaf i, the far end of the one done first
    std::uint32_t* root;
};

// A range of leaves below one node. On the way up the tree of Morton codes it joins the range of the node's sibling.
struct Range {
    std::uint32_t left, right, split;

    // Whether the Morton codes of leaves i and i + 1 differ in a lower bit than those of leaves j and j + 1; where both
    // pairs differ alike, leaf numbers are compared.
    __device__ static bool is_closer(const BuildView& view, std::uint32_t i, std::uint32_t j) {
        const std::uint64_t a = view.codes[i] ^ view.codes[i + 1], b = view.codes[j] ^ view.codes[j + 1];
        return a != b ? a < b : (i ^ (i + 1)) < (j ^ (j + 1));
    }
    // Joins the range with its sibling's. False where the sibling's is not done: its thread will then go on upwards.
    __device__ bool rise(const BuildView& view) {
        const bool with_next = left == 0 || (right + 1 < view.count && is_closer(view, right, left - 1));
        __threadfence();
        const std::uint32_t end = atomicExch(view.other_end + (with_next ? right : left - 1), with_next ? left : right);
        __threadfence();
        if (end == none) {
            return false;
        }
        split = with_next ? right + 1 : left;
        (with_next ? right : left) = end;
        return true;
    }
};

__device__ float half_area(const float* low, const float* high) {
    const float x = high[0] - low[0], y = high[1] - low[1], z = high[2] - low[2];
    return x * y + y * z + z * x;
}

__device__ GpuNode load_node(const GpuNode* node) {
    const float4 a = __ldcg(reinterpret_cast<const float4*>(node)),
                 b = __ldcg(reinterpret_cast<const float4*>(node) + 1);
    return {{a.x, a.y, a.z}, __float_as_uint(a.w), {b.x, b.y, b.z}, __float_as_uint(b.w)};
}
__device__ void store_node(GpuNode* node, const GpuNode& value) {
    float4* words = reinterpret_cast<float4*>(node);
    words[0] = make_float4(value.low[0], value.low[1], value.low[2], __uint_as_float(value.left));
    words[1] = make_float4(value.high[0], value.high[1], value.high[2], __uint_as_float(value.right));
}

// The clusters of a range of leaves as a warp holds them, one in each lane.
struct WarpClusters {
    Cluster cluster;
    float low[3], high[3];
    std::uint32_t count;

    __device__ void take_from(std::uint32_t source) {
        cluster.node = __shfl_sync(all_lanes, cluster.node, source);
        cluster.first = __shfl_sync(all_lanes, cluster.first, source);
    }
    __device__ void take_boxes_from(std::uint32_t source) {
        for (int k = 0; k < 3; ++k) {
            low[k] = __shfl_sync(all_lanes, low[k], source);
            high[k] = __shfl_sync(all_lanes, high[k], source);
        }
    }

    // Loads up to 16 clusters of each half of a range, packed into the lowest lanes of the warp.
    __device__ static WarpClusters load(const BuildView& view, const Range& range, std::uint32_t lane) {
        WarpClusters w;
        const std::uint32_t from = lane < merge_to ? range.left : range.split, at = lane % merge_to;
        const std::uint32_t end = lane < merge_to ? range.split : range.right + 1;
        w.cluster = {none, none};
        if (from + at < end) {
            const uint2 words = __ldcg(reinterpret_cast<const uint2*>(view.clusters + from + at));
            w.cluster = {words.x, words.y};
        }
        const std::uint32_t valid = __ballot_sync(all_lanes, w.cluster.node != none);
        const std::uint32_t in_left = __popc(valid & 0xffffu);
        w.count = __popc(valid);
        w.take_from(lane < in_left ? lane : (lane - in_left + merge_to) & 31u);
        if (lane < w.count) {
            const GpuNode node = load_node(view.nodes + w.cluster.node);
            for (int k = 0; k < 3; ++k) {
                w.low[k] = node.low[k];
                w.high[k] = node.high[k];
            }
        }
        return w;
    }

    // Returns the lane of the neighbouring cluster whose joint bounding box with this lane's has the least surface; of
    // equal ones the first, so that at least one pair of clusters choose each other.
    __device__ std::uint32_t nearest(std::uint32_t lane) const {
        std::uint32_t best = none;
#pragma unroll
        for (int distance = 1; distance <= search_radius; ++distance) {
            float joint_low[3], joint_high[3];
            for (int k = 0; k < 3; ++k) {
                joint_low[k] = fminf(low[k], __shfl_down_sync(all_lanes, low[k], distance));
                joint_high[k] = fmaxf(high[k], __shfl_down_sync(all_lanes, high[k], distance));
            }
            const std::uint32_t area =
                lane + distance < count ? __float_as_uint(half_area(joint_low, joint_high)) & ~31u : ~31u;
            const std::uint32_t area_before = __shfl_up_sync(all_lanes, area, distance);
            if (lane + distance < count) {
                best = min(best, area | (lane + distance));
            }
            if (lane >= distance && lane < count) {
                best = min(best, area_before | (lane - distance));
            }
        }
        return best & 31u;
    }

    // Merges the pairs of clusters that chose each other as nearest.
    __device__ void merge(const BuildView& view, std::uint32_t lane, std::uint8_t* source_of) {
        const std::uint32_t other = nearest(lane);
        const bool mutual = __shfl_sync(all_lanes, other, other) == lane && lane < count && other < count;
        WarpClusters partner = *this;
        partner.take_from(other);
        partner.take_boxes_from(other);
        if (mutual && lane < other) {
            GpuNode node;
            for (int k = 0; k < 3; ++k) {
                node.low[k] = low[k] = fminf(low[k], partner.low[k]);
                node.high[k] = high[k] = fmaxf(high[k], partner.high[k]);
            }
            node.left = cluster.node;
            node.right = partner.cluster.node;
            // An inner node's number follows from its second child's first leaf, which no two inner nodes share.
            cluster.node = view.count - 1 + max(cluster.first, partner.cluster.first);
            cluster.first = min(cluster.first, partner.cluster.first);
            store_node(view.nodes + cluster.node, node);
        }
        const std::uint32_t kept = __ballot_sync(all_lanes, lane < count && !(mutual && lane > other));
        if ((kept >> lane & 1u) != 0) {
            source_of[__popc(kept & ((1u << lane) - 1u))] = static_cast<std::uint8_t>(lane);
        }
        __syncwarp();
        count = __popc(kept);
        const std::uint32_t source = lane < count ? source_of[lane] : lane;
        take_from(source);
        take_boxes_from(source);
        __syncwarp();
    }
};

__device__ void merge_range(const BuildView& view, const Range& range, bool is_all, std::uint32_t lane,
                            std::uint8_t* source_of) {
    WarpClusters clusters = WarpClusters::load(view, range, lane);
    const std::uint32_t target = is_all ? 1 : merge_to;
    while (clusters.count > target) {
        clusters.merge(view, lane, source_of);
    }
    if (is_all) {
        if (lane == 0) {
            *view.root = clusters.cluster.node;
        }
    } else if (lane < merge_to) {
        const bool held = lane < clusters.count;
        reinterpret_cast<uint2*>(view.clusters + range.left)[lane] =
            held ? make_uint2(clusters.cluster.node, clusters.cluster.first) : make_uint2(none, none);
    }
    __threadfence();
    __syncwarp();
}

__global__ void __launch_bounds__(block) hploc(const __grid_constant__ BuildView view) {
    __shared__ std::uint8_t sources[block];
    const std::uint32_t index = blockIdx.x * blockDim.x + threadIdx.x, lane = threadIdx.x & 31u;
    std::uint8_t* source_of = sources + (threadIdx.x & ~31u);
    Range range{index, index, 0};
    bool rising = index < view.count;
    while (__any_sync(all_lanes, rising)) {
        rising = rising && range.rise(view);
        const std::uint32_t size = range.right - range.left + 1;
        std::uint32_t to_merge = __ballot_sync(all_lanes, rising && (size > merge_to || size == view.count));
        while (to_merge != 0) {
            const int selected = __ffs(static_cast<int>(to_merge)) - 1;
            to_merge &= to_merge - 1;
            const Range theirs{__shfl_sync(all_lanes, range.left, selected),
                               __shfl_sync(all_lanes, range.right, selected),
                               __shfl_sync(all_lanes, range.split, selected)};
            merge_range(view, theirs, theirs.right - theirs.left + 1 == view.count, lane, source_of);
        }
        rising = rising && size != view.count;
    }
}

__global__ void __launch_bounds__(block) lbvh(const __grid_constant__ BuildView view) {
    const std::uint32_t index = blockIdx.x * blockDim.x + threadIdx.x;
    if (index >= view.count) {
        return;
    }
    Range range{index, index, 0};
    // A range's node number is kept at both ends of the range, in clusters[left].node and clusters[right].first, where
    // the range's parent reads it.
    while (range.right - range.left + 1 != view.count && range.rise(view)) {
        const std::uint32_t left = __ldcg(&view.clusters[range.split - 1].first);
        const std::uint32_t right = __ldcg(&view.clusters[range.split].node);
        const GpuNode a = load_node(view.nodes + left), b = load_node(view.nodes + right);
        GpuNode node;
        for (int k = 0; k < 3; ++k) {
            node.low[k] = fminf(a.low[k], b.low[k]);
            node.high[k] = fmaxf(a.high[k], b.high[k]);
        }
        node.left = left;
        node.right = right;
        const std::uint32_t number = view.count - 1 + range.split;
        store_node(view.nodes + number, node);
        view.clusters[range.left].node = number;
        view.clusters[range.right].first = number;
        if (range.right - range.left + 1 == view.count) {
            *view.root = number;
        }
    }
}

}  // namespace

struct GpuTreeMemory {
    explicit GpuTreeMemory(std::uint32_t primitives)
        : count(primitives),
          bounds(1),
          codes(primitives),
          sorted_codes(primitives),
          numbers(primitives),
          sorted_numbers(primitives),
          nodes(2 * static_cast<std::size_t>(primitives)),
          clusters(primitives),
          other_end(primitives),
          root(1),
          sort_bytes(bytes_to_sort(primitives)),
          sort_storage(sort_bytes) {}

    static std::size_t bytes_to_sort(std::uint32_t primitives) {
        std::size_t bytes = 0;
        check(cub::DeviceRadixSort::SortPairs(
            nullptr, bytes, static_cast<const std::uint64_t*>(nullptr), static_cast<std::uint64_t*>(nullptr),
            static_cast<const std::uint32_t*>(nullptr), static_cast<std::uint32_t*>(nullptr), primitives, 0, 63));
        return bytes;
    }

    // Sorts leaves by (Morton code, primitive): the radix sort is stable.
    BuildView sort(const Box* boxes) {
        const std::uint32_t blocks = (count + block - 1) / block;
        clear_bounds<<<1, 32>>>(bounds.data());
        bound_centres<<<1056, 256>>>(boxes, count, bounds.data());
        morton_codes<<<blocks, block>>>(boxes, count, bounds.data(), codes.data(), numbers.data());
        check(cub::DeviceRadixSort::SortPairs(sort_storage.data(), sort_bytes, codes.data(), sorted_codes.data(),
                                              numbers.data(), sorted_numbers.data(), count, 0, 63));
        check(cudaMemsetAsync(root.data(), 0, sizeof(std::uint32_t)));
        make_leaves<<<blocks, block>>>(boxes, sorted_numbers.data(), count, nodes.data(), clusters.data(),
                                       other_end.data());
        check(cudaGetLastError());
        return {count, sorted_codes.data(), nodes.data(), clusters.data(), other_end.data(), root.data()};
    }

    std::uint32_t count;
    Memory<CentreBounds> bounds;
    Memory<std::uint64_t> codes, sorted_codes;
    Memory<std::uint32_t> numbers, sorted_numbers;
    Memory<GpuNode> nodes;
    Memory<Cluster> clusters;
    Memory<std::uint32_t> other_end, root;
    std::size_t sort_bytes;
    Memory<unsigned char> sort_storage;
};

GpuTree::GpuTree(std::uint32_t primitives) : memory_(std::make_unique<GpuTreeMemory>(primitives)) {}
GpuTree::~GpuTree() = default;

void GpuTree::build_lbvh(const Box* device_boxes) {
    const BuildView view = memory_->sort(device_boxes);
    if (view.count > 1) {
        lbvh<<<(view.count + block - 1) / block, block>>>(view);
        check(cudaGetLastError());
    }
}

void GpuTree::build_hploc(const Box* device_boxes) {
    const BuildView view = memory_->sort(device_boxes);
    if (view.count > 1) {
        hploc<<<(view.count + block - 1) / block, block>>>(view);
        check(cudaGetLastError());
    }
}

std::uint32_t GpuTree::primitives() const { return memory_->count; }
const GpuNode* GpuTree::device_nodes() const { return memory_->nodes.data(); }
const std::uint32_t* GpuTree::device_root() const { return memory_->root.data(); }

BinaryTree GpuTree::download() const {
    const std::uint32_t count = memory_->count;
    BinaryTree tree;
    if (count == 0) {
        return tree;
    }
    std::vector<GpuNode> nodes(2 * static_cast<std::size_t>(count) - 1);
    std::uint32_t root = 0;
    check(cudaMemcpy(nodes.data(), memory_->nodes.data(), nodes.size() * sizeof(GpuNode), cudaMemcpyDeviceToHost));
    check(cudaMemcpy(&root, memory_->root.data(), sizeof root, cudaMemcpyDeviceToHost));
    const auto box_of = [](const GpuNode& node) {
        return Box{{node.low[0], node.low[1], node.low[2]}, {node.high[0], node.high[1], node.high[2]}};
    };
    tree.nodes.reserve(nodes.size());
    tree.references.reserve(count);
    tree.nodes.push_back({box_of(nodes[root]), 0, 0});
    std::vector<std::pair<std::uint32_t, std::uint32_t>> open{{root, 0}};  // GPU nodes to convert, places in tree.nodes
    while (!open.empty()) {
        const auto [number, place] = open.back();
        open.pop_back();
        const GpuNode& node = nodes[number];
        if (number < count) {
            tree.nodes[place].first = static_cast<std::uint32_t>(tree.references.size());
            tree.nodes[place].count = 1;
            tree.references.push_back(node.left);
            continue;
        }
        const std::uint32_t first = static_cast<std::uint32_t>(tree.nodes.size());
        tree.nodes[place].first = first;
        tree.nodes.push_back({box_of(nodes[node.left]), 0, 0});
        tree.nodes.push_back({box_of(nodes[node.right]), 0, 0});
        open.push_back({node.right, first + 1});
        open.push_back({node.left, first});
    }
    return tree;
}

}  // namespace pt::builder
