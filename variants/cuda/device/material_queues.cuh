// How kernels append paths to queues by material type (material_queues.h), and how their blocks take paths from them.
#pragma once

#include "variants/cuda/device/append.cuh"
#include "variants/cuda/device/material_queues.h"

// The material types that end paths, a bit each.
__device__ constexpr std::uint32_t types_that_end_paths() {
    using namespace pt::material_trait;
    std::uint32_t types = 0;
#define PT_ADD_TYPE(name, Type, traits) \
    types |= ((traits)&ends_paths) != 0 ? 1u << static_cast<std::uint32_t>(pt::MaterialType::name) : 0u;
    PT_MATERIALS(PT_ADD_TYPE)
#undef PT_ADD_TYPE
    return types;
}

// Kinds of paths that are kept apart.
struct QueueKinds {
    static constexpr bool keeps_ends = pt::cuda::keeps_ended_paths(Configuration::features, tuned::by_material != 0);
    static constexpr std::uint32_t ending = 0;  // kind of a path that its hit ends, if keeps_ends
    static constexpr auto surfaces = pt::cuda::kinds_of_hits(Configuration::features, tuned::by_material != 0);
    static constexpr std::uint32_t count = pt::cuda::kinds_of_paths(Configuration::features, tuned::by_material != 0);
    static_assert(count > 0 && count <= 16, "the table of kinds has four bits for each");

    // True only if shading the path's hit ends the path, whatever the random numbers.
    __device__ static bool is_ended_by(const Scene& scene, const Path& path, const Hit& hit) {
        if (!hit.side.exists() || path.segment + 1 >= scene.longest_path()) {
            return true;
        }
        constexpr std::uint32_t types = types_that_end_paths();
        return ((types >> static_cast<std::uint32_t>(scene.surfaces[hit.side.object()].type)) & 1u) != 0;
    }
    __device__ static std::uint32_t of(const Scene& scene, std::uint32_t object) {
        const std::uint32_t type = static_cast<std::uint32_t>(scene.surfaces[object].type);
        return count == 1 ? 0 : static_cast<std::uint32_t>(surfaces.table >> (4 * type)) & 15u;
    }
};

namespace pt::cuda {

// Each kind has tuned::append_counters queues, since appending to one counter waits for all others that do.
inline constexpr std::uint32_t queues_of_all_kinds = QueueKinds::count * tuned::append_counters;
inline constexpr std::uint32_t slots_per_chunk = blocks_per_chunk * kernel_config.block;

__device__ inline std::uint32_t& place_of_chunk(const MaterialQueues<Real>& queues, std::uint32_t queue,
                                                std::uint32_t position) {
    return queues.chunks[static_cast<std::size_t>(queue) * queues.chunks_per_queue + position / slots_per_chunk];
}

// Slots that a thread block works on: `first` to `first` + `count` - 1, with paths of one queue.
struct BlockSlots {
    std::uint32_t first, count;
};

// The slots of the block's paths: the first blocks have those of the first queue, and so on; blocks beyond the last
// queue get none. Every thread of the block must call it, once in a kernel.
__device__ inline BlockSlots slots_of_block(const MaterialQueues<Real>& in) {
    constexpr std::uint32_t block = kernel_config.block;
    __shared__ BlockSlots slots;
    if (threadIdx.x < warp_size) {
        if (lane() == 0) {
            slots = {0, 0};
        }
        __syncwarp();
        std::uint32_t before = 0;  // number of blocks of the queues looked at so far
        for (std::uint32_t first = 0; first < queues_of_all_kinds && before <= blockIdx.x; first += warp_size) {
            const std::uint32_t queue = first + lane();
            const std::uint32_t paths = queue < queues_of_all_kinds ? in.counts[queue * counter_stride] : 0;
            const std::uint32_t blocks = (paths + block - 1) / block;
            const std::uint32_t end = before + sum_up_to_lane(blocks);
            if (blockIdx.x < end && blockIdx.x >= end - blocks) {
                const std::uint32_t position = (blockIdx.x - (end - blocks)) * block;
                const std::uint32_t place = place_of_chunk(in, queue, position) - 1;
                const std::uint32_t left = paths - position;
                slots = {place * slots_per_chunk + position % slots_per_chunk, left < block ? left : block};
            }
            before = __shfl_sync(all_lanes, end, static_cast<int>(warp_size - 1));
        }
    }
    __syncthreads();
    return slots;
}

// Positions of a queue that a block has reserved, from `first` on: in the chunk at places[0] of the store and, where
// they go on, in that at places[1].
struct Reserved {
    std::uint32_t first, places[2];
};

// Reserves positions at the end of a queue. Whoever reserves a chunk's first position finds the chunk a place in the
// store, before it waits for anything; whoever reserves other positions waits until the chunk has its place.
__device__ inline Reserved reserve(const MaterialQueues<Real>& out, std::uint32_t queue, std::uint32_t count) {
    const std::uint32_t first = atomicAdd(&out.counts[queue * counter_stride], count);
    const std::uint32_t last = first + count - 1;
    std::uint32_t& chunk = place_of_chunk(out, queue, first);
    const auto find_place = [&](std::uint32_t& of) {
        const std::uint32_t place = atomicAdd(&out.counts[queues_of_all_kinds * counter_stride], 1u);
        atomicExch(&of, place + 1);
        return place;
    };
    Reserved reserved{first, {0, 0}};
    const bool is_first = first % slots_per_chunk == 0;
    if (is_first) {
        reserved.places[0] = find_place(chunk);
    }
    if (last / slots_per_chunk != first / slots_per_chunk) {
        reserved.places[1] = find_place(place_of_chunk(out, queue, last));
    }
    if (!is_first) {
        std::uint32_t found = 0;
        while (found == 0) {
            found = atomicAdd(&chunk, 0u);
        }
        reserved.places[0] = found - 1;
    }
    return reserved;
}

// Gives each thread that keeps a path a slot in a queue of its kind. Every thread of the block must call it, once in a
// kernel.
__device__ inline std::uint32_t append_to_kind(const MaterialQueues<Real>& out, bool keeps, std::uint32_t kind) {
    __shared__ std::uint32_t kept[QueueKinds::count];
    __shared__ Reserved reserved[QueueKinds::count];
    if (threadIdx.x < QueueKinds::count) {
        kept[threadIdx.x] = 0;
    }
    __syncthreads();
    unsigned peers;  // lanes whose paths are of one kind, as the calling lane's
    if constexpr (QueueKinds::count == 1) {
        const unsigned keeping = __ballot_sync(all_lanes, keeps);
        peers = keeps ? keeping : ~keeping;
    } else {
        peers = __match_any_sync(all_lanes, keeps ? kind : QueueKinds::count);
    }
    const std::uint32_t rank = rank_in(peers);
    std::uint32_t offset = 0;
    if (keeps && rank == 0) {
        offset = atomicAdd(&kept[kind], static_cast<std::uint32_t>(__popc(peers)));
    }
    offset = __shfl_sync(all_lanes, offset, __ffs(static_cast<int>(peers)) - 1) + rank;
    __syncthreads();
    if (threadIdx.x < QueueKinds::count && kept[threadIdx.x] != 0) {
        const std::uint32_t queue = threadIdx.x * tuned::append_counters + blockIdx.x % tuned::append_counters;
        reserved[threadIdx.x] = reserve(out, queue, kept[threadIdx.x]);
    }
    __syncthreads();
    if (!keeps) {
        return 0;
    }
    const Reserved& mine = reserved[kind];
    const std::uint32_t position = mine.first + offset;
    const bool is_next = position / slots_per_chunk != mine.first / slots_per_chunk;
    return mine.places[is_next ? 1 : 0] * slots_per_chunk + position % slots_per_chunk;
}

}  // namespace pt::cuda
