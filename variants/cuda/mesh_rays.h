// Host side of the kernel that takes a queue's rays through meshes (device/mesh_queue.h), with traversal=persistent.
#pragma once

#include <algorithm>

#include "variants/cuda/device/mesh_queue.h"
#include "variants/cuda/integrator.h"

namespace pt::cuda {

inline constexpr KernelPart mesh_rays_part =
    kernel_part<IntersectMeshesParameters>("variants/integrator/wavefront_fetching.cuh");

template <class Real>
class MeshRays {
public:
    MeshRays(JobOf<Real>& job, const IntegratorNeeds& needs) : job_(job), bounds_(needs.key_bounds) {
        if (needs.traits.traversal.needs_own_kernel) {
            const int blocks = job.module->blocks_per_multiprocessor(IntersectMeshesParameters<Real>::kernel,
                                                                     fetching_block(job.block));
            blocks_ = static_cast<std::uint32_t>(blocks) * job.multiprocessors;
        }
    }

    // Whether rays go through meshes in a kernel of their own.
    bool are_apart() const { return blocks_ != 0; }
    // The list that kernels put such rays into; empty where no kernel takes them.
    const MeshQueue& queue() const { return queue_; }
    // Takes memory for a list of at most `rays`.
    void reserve(Arena& arena, std::uint32_t rays) {
        if (are_apart()) {
            queue_ = {arena.take<std::uint32_t>(rays), arena.take<ListCounts>(1)};
        }
    }
    // Enqueues the start of a batch, in which the list is empty.
    void begin() {
        if (are_apart()) {
            clear(queue_.counts, sizeof(ListCounts), job_.stream);
        }
    }
    // Enqueues the kernel that takes the listed rays, of at most `paths`, through meshes. With `keys` it also writes
    // their sort keys.
    void take(const PathStore& store, const std::uint32_t* order, std::uint32_t paths, StoredHit<Real>* hits,
              std::uint32_t* keys = nullptr, std::uint32_t bits = 0, std::uint32_t chunk = 1) {
        const std::uint32_t block = fetching_block(job_.block);
        job_.launch_blocks(
            std::min(blocks_, (paths + block - 1) / block), block,
            IntersectMeshesParameters<Real>{job_.scene, store, order, queue_, hits, keys, bits, chunk, bounds_});
    }

private:
    JobOf<Real>& job_;
    KeyBounds bounds_;
    std::uint32_t blocks_ = 0;  // blocks of the kernel: as many as fit at once; 0: there is no such kernel
    MeshQueue queue_;
};

}  // namespace pt::cuda
