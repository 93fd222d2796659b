// Paths of a thread block between two stages, in shared memory, and a ring of them for each kind of next stage: a warp
// takes up to 32 paths of one kind, whoever worked on them before, runs their stage, and hands them back. No warp waits
// for another: a ring's ends are moved by atomic operations, and an entry itself says whether it is filled.
//
// By the pigeonhole principle enough paths keep every warp full: other warps hold 32 paths each, and among the rest
// some kind has at least 32 as soon as there are more than 31 for each kind.
#pragma once

#include "variants/cuda/device/packed_path.cuh"
#include "variants/cuda/device/warp_lock.cuh"

// The paths that a warp takes from the pool: lanes below `count` have a slot each, all of one kind.
struct Taken {
    std::uint32_t kind, count, slot;
    bool finished;  // every path slot of the block is retired: no path is left to work on
};

struct PoolSize {
    static constexpr std::uint32_t enough = kernel_config.block - warp_size + 31 * Kinds::lists + 1;
    static constexpr std::uint32_t wanted = tuned::pool != 0 ? tuned::pool : enough;

    // Number of ring entries for `slots` slots: a power of two, so that positions may wrap around.
    __device__ static constexpr std::uint32_t ring(std::uint32_t slots) {
        std::uint32_t entries = warp_size;
        while (entries < slots) {
            entries *= 2;
        }
        return entries;
    }
    // Number of a block's path slots: as many as wanted, in whole warps, as far as its shared memory holds them (48 KiB
    // without asking for more).
    __device__ static constexpr std::uint32_t slots() {
        std::uint32_t fit = (wanted + warp_size - 1) / warp_size * warp_size;
        while (16 * PackedPath::columns * fit + 2 * Kinds::lists * ring(fit) > 49152 - 512 - scene_bytes_shared) {
            fit -= warp_size;
        }
        return fit;
    }
};

class PathPool {
public:
    static constexpr std::uint32_t slots = PoolSize::slots();

    // Empties the pool: no slot has a path, and all wait for one. Every thread of the block must call it.
    __device__ void fill() {
        Path none = {};
        none.segment = Path::ended;
        for (std::uint32_t i = threadIdx.x; i < ring; i += kernel_config.block) {
            for (std::uint32_t kind = 0; kind < Kinds::lists; ++kind) {
                rings_[kind][i] = kind == Kinds::over && i < slots ? static_cast<std::uint16_t>(i) : empty;
            }
            if (i < slots) {
                store(i, none, Hit{}, pt::Walk{});
            }
        }
        if (threadIdx.x <= Kinds::nothing) {
            heads_[threadIdx.x] = 0;
            tails_[threadIdx.x] = threadIdx.x == Kinds::over ? slots : 0;
        }
        __syncthreads();
    }

    // Hands back the lane's slot to the pool, with the kind of its path's next stage, and takes slots of the kind that
    // most paths wait for. Every lane of the warp must call it.
    __device__ Taken exchange(std::uint32_t slot, std::uint32_t kind) {
        put(slot, kind);
        return take();
    }

    __device__ void load(std::uint32_t slot, const Scene& scene, Path& path, Hit& hit, pt::Walk& walk) const {
        PackedPath packed;
        for (std::uint32_t i = 0; i < PackedPath::columns; ++i) {
            packed.column[i] = columns_[i][slot];
        }
        packed.unpack(scene, path, hit, walk);
    }
    __device__ void store(std::uint32_t slot, const Path& path, const Hit& hit, const pt::Walk& walk) {
        PackedPath packed;
        packed.pack(path, hit, walk);
        for (std::uint32_t i = 0; i < PackedPath::columns; ++i) {
            columns_[i][slot] = packed.column[i];
        }
    }

private:
    static constexpr std::uint32_t ring = PoolSize::ring(slots);
    static constexpr std::uint16_t empty = 0xffff;

    __device__ void put(std::uint32_t slot, std::uint32_t kind) {
        const unsigned peers = __match_any_sync(pt::cuda::all_lanes, kind);
        const std::uint32_t rank = pt::cuda::rank_in(peers);
        std::uint32_t first = 0;
        if (rank == 0) {
            first = atomicAdd(&tails_[kind], static_cast<std::uint32_t>(__popc(peers)));
        }
        first = __shfl_sync(pt::cuda::all_lanes, first, __ffs(static_cast<int>(peers)) - 1);
        // Positions a ring's length apart share an entry, perhaps not emptied yet by the earlier position's reader.
        bool has_entry = kind < Kinds::lists;
        while (__any_sync(pt::cuda::all_lanes, has_entry)) {
            if (has_entry) {
                std::uint16_t& entry = rings_[kind][(first + rank) % ring];
                if (pt::cuda::load_acquire(entry) == empty) {
                    pt::cuda::store_release(entry, static_cast<std::uint16_t>(slot));
                    has_entry = false;
                }
            }
        }
    }

    __device__ Taken take() {
        const std::uint32_t lane = pt::cuda::lane();
        Taken taken;
        std::uint32_t first = 0;
        bool has_taken = false;
        do {
            // A ring's head is read before its tail: then the tail is not behind it, and the entries in between are
            // there until the head moves.
            const std::uint32_t head = lane <= Kinds::retired ? pt::cuda::load_acquire(heads_[lane]) : 0;
            const std::uint32_t tail = lane <= Kinds::retired ? pt::cuda::load_acquire(tails_[lane]) : 0;
            const std::uint32_t fullest = pt::cuda::warp_max(lane < Kinds::lists ? (tail - head) << 5 | lane : 0);
            const std::uint32_t waiting = fullest >> 5;
            taken.kind = fullest & 31u;
            taken.count = waiting < warp_size ? waiting : warp_size;
            taken.finished = __shfl_sync(pt::cuda::all_lanes, tail, Kinds::retired) == slots;
            bool moved = false;
            if (waiting != 0 && lane == taken.kind) {
                moved = atomicCAS(&heads_[lane], head, head + taken.count) == head;
            }
            has_taken = __any_sync(pt::cuda::all_lanes, moved);
            first = __shfl_sync(pt::cuda::all_lanes, head, static_cast<int>(taken.kind));
            if (waiting == 0 && !taken.finished) {
                __nanosleep(200);
            }
        } while (!has_taken && !taken.finished);
        taken.count = has_taken ? taken.count : 0;
        // A ring entry that was taken before it was written will be written in a moment, so wait for it.
        taken.slot = 0;
        bool waits = lane < taken.count;
        while (__any_sync(pt::cuda::all_lanes, waits)) {
            if (waits) {
                std::uint16_t& entry = rings_[taken.kind][(first + lane) % ring];
                const std::uint16_t found = pt::cuda::load_acquire(entry);
                if (found != empty) {
                    pt::cuda::store_release(entry, empty);
                    taken.slot = found;
                    waits = false;
                }
            }
        }
        return taken;
    }

    uint4 columns_[PackedPath::columns][slots];
    // Head and tail positions of each kind's ring; for kinds without a ring the tail counts the slots handed back.
    std::uint32_t heads_[Kinds::nothing + 1], tails_[Kinds::nothing + 1];
    std::uint16_t rings_[Kinds::lists][ring];
};
