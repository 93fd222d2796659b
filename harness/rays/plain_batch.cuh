// Kernels that trace one ray per thread with the traversal and leaf tests of the path tracing kernels, as a check of
// the persistent kernel and to compare accelerators without scheduling; and a brute-force kernel for the expected hits.
#pragma once

#include "harness/rays/ray_batch.h"
#include "kernels/shapes/mesh.h"

namespace pt::rays {

struct PlainView {
    TreeView tree;
    const LeafTriangle* leaves;
    const Ray* rays;
    Hit* hits;
    std::uint32_t count;
    bool any;
};

template <class Traversal, class Counter>
__device__ inline Hit trace_plain(const PlainView& batch, std::uint32_t index, Counter& counter) {
    const Ray ray = batch.rays[index];
    const Vec3<float> origin = vector_of<float>(ray.origin), direction = vector_of<float>(ray.direction);
    const auto sheared = ShearedDirection<float>::of(direction);
    Hit best{ray.t_max, no_primitive};
    Traversal::traverse(
        batch.tree, origin, direction, best.t,
        [&](std::uint32_t first, std::uint32_t count) {
            for (std::uint32_t slot = first; slot < first + count; ++slot) {
                const LeafTriangle leaf = batch.leaves[slot];
                keep_nearer(intersect(leaf.triangle<float>(), origin, sheared), leaf.primitive(), best);
                if (batch.any && best.primitive != no_primitive) {
                    best = {-1.0f, 0};
                    return;
                }
            }
        },
        counter);
    return batch.any && best.primitive != no_primitive ? Hit{0.0f, 0} : best;
}

template <class Traversal>
__global__ void trace_plain(const __grid_constant__ PlainView batch) {
    const std::uint32_t index = blockIdx.x * blockDim.x + threadIdx.x;
    if (index < batch.count) {
        NoTraversalCounter none;
        batch.hits[index] = trace_plain<Traversal>(batch, index, none);
    }
}

// Adds up the nodes visited, boxes tested and triangles tested by all rays of a batch.
template <class Traversal>
__global__ void count_work(const __grid_constant__ PlainView batch, unsigned long long* sums) {
    const std::uint32_t index = blockIdx.x * blockDim.x + threadIdx.x;
    if (index < batch.count) {
        TraversalCounter counter;
        (void)trace_plain<Traversal>(batch, index, counter);
        atomicAdd(sums, counter.nodes_visited);
        atomicAdd(sums + 1, counter.boxes_tested);
        atomicAdd(sums + 2, counter.primitives_tested);
    }
}

// Tests every triangle for each ray: keys[ray], initially the key of {t_max, no_primitive}, becomes the smallest key
// (bits of t, then primitive) of all hits. A thread block takes 128 rays and every gridDim.y-th triangle.
__global__ void brute_force(const Ray* rays, std::uint32_t count, const Triangle<float>* triangles,
                            std::uint32_t triangle_count, unsigned long long* keys) {
    const std::uint32_t index = blockIdx.x * blockDim.x + threadIdx.x;
    if (index >= count) {
        return;
    }
    const Ray ray = rays[index];
    const Vec3<float> origin = vector_of<float>(ray.origin);
    const auto sheared = ShearedDirection<float>::of(vector_of<float>(ray.direction));
    Hit best{ray.t_max, no_primitive};
    for (std::uint32_t i = blockIdx.y; i < triangle_count; i += gridDim.y) {
        keep_nearer(intersect(triangles[i], origin, sheared), i, best);
    }
    atomicMin(keys + index, static_cast<unsigned long long>(__float_as_uint(best.t)) << 32 | best.primitive);
}

}  // namespace pt::rays
