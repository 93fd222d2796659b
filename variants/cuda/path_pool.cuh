// A block's paths between two stages, in shared memory, and lists of them by what comes next for each: a warp takes up
// to 32 paths of one kind, whoever worked on them before, does what comes next, and hands them back. No warp waits for
// another, but for a moment at the lock of the lists.
//
// By the pigeonhole principle enough paths keep every warp full: those that other warps hold are 32 a warp, and of the
// rest some kind has at least 32 as soon as there are more than 31 for each kind.
#pragma once

#include "variants/cuda/packed_path.cuh"
#include "variants/cuda/warp_lock.cuh"

// What a warp takes: lanes below `count` have a slot each, all of one kind.
struct Taken {
    std::uint32_t kind, count, slot;
    bool finished;  // all slots of the block are retired
};

class PathPool {
    static constexpr std::uint32_t bytes_a_slot = 16 * PackedPath::columns + 2 * Kinds::lists;
    // Of a block's shared memory, which has 48 KiB without asking for more.
    static constexpr std::uint32_t most = (49152 - 512) / bytes_a_slot / warp_size * warp_size;
    static constexpr std::uint32_t enough = kernel_config.block - warp_size + 31 * Kinds::lists + 1;
    static constexpr std::uint32_t wanted = tuned::pool != 0 ? tuned::pool : enough;
    static constexpr std::uint32_t whole_warps = (wanted + warp_size - 1) / warp_size * warp_size;

public:
    static constexpr std::uint32_t slots = whole_warps < most ? whole_warps : most;

    // No slot has a path, and all wait for one. Every thread of the block must call it.
    __device__ void fill() {
        Path none = {};
        none.segment = Path::ended;
        for (std::uint32_t slot = threadIdx.x; slot < slots; slot += kernel_config.block) {
            lists_[Kinds::over][slot] = static_cast<std::uint16_t>(slot);
            store(slot, none, Hit{}, pt::Walk{});
        }
        if (threadIdx.x <= Kinds::nothing) {
            counts_[threadIdx.x] = threadIdx.x == Kinds::over ? slots : 0;
        }
        if (threadIdx.x == 0) {
            locked_ = 0;
        }
        __syncthreads();
    }

    // Hands back the lane's slot, with the kind of what comes next for it, and takes what most paths wait for. Every
    // lane of the warp must call it.
    __device__ Taken exchange(std::uint32_t slot, std::uint32_t kind) {
        const unsigned peers = __match_any_sync(pt::cuda::all_lanes, kind);
        const std::uint32_t rank = pt::cuda::rank_in(peers);
        pt::cuda::acquire(locked_);
        const std::uint32_t before = counts_[kind];
        __syncwarp();
        if (rank == 0) {
            counts_[kind] = before + __popc(peers);
        }
        if (kind < Kinds::lists) {
            lists_[kind][before + rank] = static_cast<std::uint16_t>(slot);
        }
        __syncwarp();
        const std::uint32_t waiting = pt::cuda::lane() < Kinds::lists ? counts_[pt::cuda::lane()] : 0;
        const std::uint32_t fullest = pt::cuda::warp_max(waiting << 5 | pt::cuda::lane());
        const std::uint32_t total = fullest >> 5;
        Taken taken;
        taken.kind = fullest & 31u;
        taken.count = min(total, warp_size);
        taken.slot = pt::cuda::lane() < taken.count ? lists_[taken.kind][total - 1 - pt::cuda::lane()] : 0;
        taken.finished = counts_[Kinds::retired] == slots;
        if (pt::cuda::lane() == 0) {
            counts_[taken.kind] = total - taken.count;
        }
        pt::cuda::release(locked_);
        return taken;
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
    uint4 columns_[PackedPath::columns][slots];
    std::uint32_t counts_[Kinds::nothing + 1];  // of each list; of the rest how many were handed back
    std::uint32_t locked_;
    std::uint16_t lists_[Kinds::lists][slots];
};
