#include "harness/cuda/queue_memory.h"

#include <fmt/format.h>

#include "harness/cuda/handles.h"

namespace pt::cuda {

namespace {

bool copies_whole_paths(const Job& job) {
    return (job.compaction != nullptr && !job.appends_in_kernel && job.compaction->moves_paths()) ||
           (job.sorting != nullptr && job.sorting->moves_paths());
}

// What the kernels write, unless somebody copies whole paths.
PathFields carried_fields(const Job& job, FeatureSet features) {
    return copies_whole_paths(job) ? every_path_field : PathFields::of(features);
}

std::uint32_t capacity_of(const Job& job) {
    const std::uint64_t pool = std::uint64_t{job.pixels} * job.samples_in_flight;
    if (pool > 0x7fffffffu) {
        throw Error(fmt::format("{} paths in flight: spp_in_flight is too large for {} pixels", pool, job.pixels));
    }
    if (!job.appends_in_kernel) {
        return static_cast<std::uint32_t>(pool);
    }
    // Each part has room for its share of the blocks.
    const std::uint64_t blocks = (pool + job.block - 1) / job.block;
    const std::uint64_t blocks_per_part = (blocks + job.append_counters - 1) / job.append_counters;
    return static_cast<std::uint32_t>(blocks_per_part * job.append_counters * job.block);
}

void reserve_order(Arena& arena, Job& job) {
    Queue& queue = job.queue;
    if (job.compaction != nullptr || job.sorting != nullptr) {
        queue.order = arena.take<std::uint32_t>(queue.capacity);
        queue.order_spare = arena.take<std::uint32_t>(queue.capacity);
    }
    if (job.sorting != nullptr) {
        queue.keys = arena.take<std::uint32_t>(queue.capacity);
        queue.keys_spare = arena.take<std::uint32_t>(queue.capacity);
    }
}

}  // namespace

template <class Real>
std::vector<unsigned char> object_classes(const SceneView<Real>& scene) {
    std::vector<unsigned char> classes;
    for (std::uint32_t object = 0; object < scene.object_material.size; ++object) {
        const MaterialType type = scene.materials[scene.object_material[object]].type;
        classes.push_back(type == MaterialType::mirror || type == MaterialType::dielectric ? 1 : 0);
    }
    return classes;
}

void reserve_queue(Arena& arena, const QueueNeeds& needs, Job& job, CudaFacts& facts) {
    const std::size_t before = arena.used();
    Queue& queue = job.queue;
    queue.capacity = capacity_of(job);
    const std::size_t store_bytes =
        needs.layout.bytes(queue.capacity, needs.real_bytes, carried_fields(job, needs.features));
    facts.path_state_bytes = store_bytes / queue.capacity;
    const auto take_paths = [&]() -> PathStore { return {arena.take_bytes(store_bytes), queue.capacity}; };
    queue.paths = take_paths();
    if (job.appends_in_kernel || (job.compaction != nullptr && job.compaction->needs_spare_paths())) {
        queue.spare = take_paths();
    }
    if (needs.hit_bytes != 0) {
        queue.hits = arena.take_bytes(queue.capacity * needs.hit_bytes);
    }
    reserve_order(arena, job);
    if (job.appends_in_kernel) {
        job.append_counts = arena.take<std::uint32_t>(std::size_t{job.append_counters} * 32 * job.longest_path);
    }
    queue.count = arena.take<std::uint32_t>(1);
    queue.count_spare = arena.take<std::uint32_t>(1);
    queue.bound = queue.capacity;
    queue.object_class = arena.take<unsigned char>(needs.object_class.size());
    if (job.compaction != nullptr && !job.appends_in_kernel) {
        job.compaction->reserve(arena, queue);
    }
    if (job.sorting != nullptr) {
        job.sorting->reserve(arena, queue);
    }
    facts.path_bytes = (arena.used() - before) / queue.capacity;
}

void upload_queue(const QueueNeeds& needs, const Job& job) {
    const Queue& queue = job.queue;
    // Positions beyond the count are carried along by sorts though nobody looks at what they hold.
    for (std::uint32_t* const index : {queue.order, queue.order_spare, queue.keys, queue.keys_spare}) {
        clear(index, std::size_t{queue.capacity} * sizeof(std::uint32_t), job.stream);
    }
    if (copies_whole_paths(job)) {
        // What the scene's kernels never write is copied along.
        clear(queue.paths.base, needs.layout.bytes(queue.capacity, needs.real_bytes, {}), job.stream);
    }
    clear(queue.count, sizeof(std::uint32_t), job.stream);
    clear(queue.count_spare, sizeof(std::uint32_t), job.stream);
    PT_CUDA_CHECK(cudaMemcpyAsync(const_cast<unsigned char*>(queue.object_class), needs.object_class.data(),
                                  needs.object_class.size(), cudaMemcpyHostToDevice, job.stream));
    PT_CUDA_CHECK(cudaStreamSynchronize(job.stream));
}

template std::vector<unsigned char> object_classes(const SceneView<float>& scene);
template std::vector<unsigned char> object_classes(const SceneView<double>& scene);

}  // namespace pt::cuda
