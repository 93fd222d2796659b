// Closest hits (or occlusion tests) of ray batches in a compressed wide BVH: persistent warps fetch new rays as lanes
// become idle (Aila and Laine 2009), a warp vote chooses between node and triangle steps, and the top of the traversal
// stack is in shared memory (Ylitie, Karras, Laine 2017, section 4). Hits equal those of cwbvh::traverse bit for bit.
#pragma once

#include "harness/rays/ray_batch.h"
#include "variants/accelerator/cwbvh.h"
#include "variants/traversal/warp_queue.cuh"

namespace pt::rays {

namespace cwbvh = accelerator::cwbvh;

// Compile-time parameters of the persistent kernel closest_hits.
template <int Threads, int BlocksPerSm, int SharedEntries, int Refill, int Vote, int Groups, bool Any = false>
struct BatchPolicy : traversal::WarpPolicy<Refill, Vote> {
    static constexpr int threads = Threads;               // threads per block
    static constexpr int blocks_per_sm = BlocksPerSm;     // resident blocks per SM; they limit registers per thread
    static constexpr int shared_entries = SharedEntries;  // traversal stack entries per thread in shared memory
    // Triangle groups that a lane can postpone. With 2, a lane visits the next node while other lanes test triangles.
    static constexpr int groups = Groups;
    static constexpr bool any = Any;  // whether rays are occlusion tests
};

// A ray for the watertight triangle test (kernels/triangle.h) on triangles in leaf slots: the operations and their
// order are the same, but axes are permuted by the choice of the rows that are read from the slot.
struct PermutedRay {
    float x, y, z;  // ray origin, permuted to the axes kx, ky, kz
    ShearedDirection<float> shear;

    __device__ static PermutedRay of(const Vec3<float>& origin, const Vec3<float>& direction) {
        PermutedRay ray;
        ray.shear = ShearedDirection<float>::of(direction);
        ray.x = component_of(origin, ray.shear.kx);
        ray.y = component_of(origin, ray.shear.ky);
        ray.z = component_of(origin, ray.shear.kz);
        return ray;
    }
};

__device__ inline void intersect_slot(const LeafTriangle* triangle, const PermutedRay& ray, Hit& best) {
    const float4* rows = reinterpret_cast<const float4*>(triangle);
    const float4 z = __ldg(rows + ray.shear.kz), x = __ldg(rows + ray.shear.kx), y = __ldg(rows + ray.shear.ky);
    const Vec3<float>& shear = ray.shear.shear;
    const float az = z.x - ray.z, bz = z.y - ray.z, cz = z.z - ray.z;
    const float ax = (x.x - ray.x) - shear.x * az, ay = (y.x - ray.y) - shear.y * az;
    const float bx = (x.y - ray.x) - shear.x * bz, by = (y.y - ray.y) - shear.y * bz;
    const float cx = (x.z - ray.x) - shear.x * cz, cy = (y.z - ray.y) - shear.y * cz;
    const float u = cx * by - cy * bx, v = ax * cy - ay * cx, w = bx * ay - by * ax;
    // The sign of a non-zero edge function is exact in float, so where two signs differ no test in double is needed.
    if (fminf(fminf(u, v), w) < 0.0f && fmaxf(fmaxf(u, v), w) > 0.0f) {
        return;
    }
    const double wide_u = edge_function_in_double(cx, cy, bx, by), wide_v = edge_function_in_double(ax, ay, cx, cy),
                 wide_w = edge_function_in_double(bx, by, ax, ay), det = wide_u + wide_v + wide_w;
    if ((fmin(fmin(wide_u, wide_v), wide_w) < 0.0 && fmax(fmax(wide_u, wide_v), wide_w) > 0.0) ||
        static_cast<float>(det) == 0.0f) {
        return;
    }
    const float t = static_cast<float>(
        (wide_u * static_cast<double>(az) + wide_v * static_cast<double>(bz) + wide_w * static_cast<double>(cz)) / det *
        static_cast<double>(shear.z));
    keep_nearer({t, static_cast<float>(det), u, v, w, t > 0.0f, false}, __float_as_uint(z.w), best);
}

struct BatchView {
    TreeView tree;
    const LeafTriangle* triangles;
    const Ray* rays;
    Hit* hits;
    std::uint32_t count;
    std::uint32_t* next;  // next ray of the batch that no lane has fetched
};

// A look-up table in shared memory of the function cwbvh::by_octant, for every byte and octant.
struct OctantOrders {
    std::uint8_t order[8][256];

    __device__ void fill() {
        for (std::uint32_t i = threadIdx.x; i < sizeof order; i += blockDim.x) {
            order[i / 256][i % 256] = static_cast<std::uint8_t>(cwbvh::by_octant(i % 256, i / 256));
        }
    }
};

// The state of a ray's traversal in a lane, which is advanced in steps.
template <class P>
class RayState {
public:
    // A lane's state without a ray. `local` holds traversal stack entries that do not fit into shared memory. It must
    // not be a member, because an array indexed at run time would force the other members into local memory too.
    __device__ RayState(const BatchView& batch, uint2* shared, uint2* local, const OctantOrders& orders)
        : batch_(batch), shared_(shared), local_(local), orders_(orders) {}

    __device__ bool active() const { return !pending_.empty() || !group_.empty(); }
    __device__ bool wants_triangle() const { return !pending_.empty(); }
    __device__ bool wants_node() const { return (P::groups == 2 ? later_ : pending_).empty() && !group_.empty(); }

    __device__ void start(std::uint32_t index) {
        const float4* words = reinterpret_cast<const float4*>(batch_.rays + index);
        const float4 o = __ldcs(words), d = __ldcs(words + 1);
        const Vec3<float> origin{o.x, o.y, o.z}, direction{d.x, d.y, d.z};
        index_ = index;
        box_ray_ = cwbvh::BoxRay::of(cwbvh::LoadedNode::of(batch_.tree.nodes, 0), origin, direction);
        ray_ = PermutedRay::of(origin, direction);
        best_ = {o.w, no_primitive};
        group_ = cwbvh::NodeGroup::root();
        depth_ = 0;
        pending_.bits = later_.bits = 0;
    }

    // Visits the nearest unvisited node of the current group. An empty current group means that no node is left.
    __device__ void visit_node() {
        const std::uint32_t index = group_.take_nearest(box_ray_.flip);
        if (!group_.empty()) {
            push();
        }
        const cwbvh::LoadedNode node = cwbvh::LoadedNode::of(batch_.tree.nodes, index);
        const std::uint32_t hits = cwbvh::boxes_hit(node, box_ray_, cwbvh::limit_of(best_.t));
        group_ = {node.child_base(),
                  (std::uint32_t{orders_.order[box_ray_.flip][hits >> 24]} << 24) | (node.contents() >> 24)};
        const cwbvh::SlotGroup found{hits & 0xffffffu, node.contents(), node.slot_base()};
        if (P::groups == 2 && !pending_.empty()) {
            later_ = found;
        } else {
            pending_ = found;
        }
        finish_if_done();
    }

    __device__ void test_triangle() {
        intersect_slot(batch_.triangles + pending_.take(), ray_, best_);
        if (P::any && best_.primitive != no_primitive) {
            best_ = {0.0f, 0};
            group_.bits = 0, depth_ = 0, pending_.bits = 0, later_.bits = 0;
        }
        if (P::groups == 2 && pending_.empty()) {
            pending_ = later_;
            later_.bits = 0;
        }
        finish_if_done();
    }

private:
    __device__ void finish_if_done() {
        if (group_.empty()) {
            if (depth_ != 0) {
                pop();
            } else if (pending_.empty()) {
                __stcs(reinterpret_cast<float2*>(batch_.hits + index_),
                       make_float2(best_.t, __uint_as_float(best_.primitive)));
            }
        }
    }
    __device__ void push() {
        if (depth_ < P::shared_entries) {
            shared_[depth_ * P::threads] = make_uint2(group_.base, group_.bits);
        } else {
            local_[depth_ - P::shared_entries] = make_uint2(group_.base, group_.bits);
        }
        ++depth_;
    }
    __device__ void pop() {
        --depth_;
        const uint2 entry =
            depth_ < P::shared_entries ? shared_[depth_ * P::threads] : local_[depth_ - P::shared_entries];
        group_ = {entry.x, entry.y};
    }

    const BatchView& batch_;
    uint2* shared_;
    uint2* local_;
    const OctantOrders& orders_;
    cwbvh::BoxRay box_ray_;
    PermutedRay ray_;
    Hit best_;
    cwbvh::NodeGroup group_{};  // child nodes still to visit; none in a lane without a ray
    cwbvh::SlotGroup pending_, later_;
    std::uint32_t index_;
    int depth_ = 0;
};

template <class P>
__global__ void __launch_bounds__(P::threads, P::blocks_per_sm) closest_hits(const __grid_constant__ BatchView batch) {
    extern __shared__ uint2 stacks[];
    uint2 local[cwbvh::largest_depth - P::shared_entries];
    __shared__ OctantOrders orders;
    orders.fill();
    __syncthreads();
    RayState<P> state(batch, stacks + threadIdx.x, local, orders);
    traversal::work_off<P>(state, batch.next, batch.count);
}

}  // namespace pt::rays
