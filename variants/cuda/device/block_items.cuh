// The samples that a block takes from the image, piece by piece, and hands to its warps.
#pragma once

#include "variants/cuda/device/items.cuh"
#include "variants/cuda/device/warp_lock.cuh"

// Pieces of work on the image: `samples_per_piece` samples of a strip of 32 pixels each, numbered strip by strip.
// `next` counts the pieces taken, in global memory.
struct Pieces {
    std::uint32_t pixels, width, first_sample, samples, samples_per_piece;
    std::uint64_t* next;

    __device__ std::uint32_t strips() const { return (pixels + warp_size - 1) / warp_size; }
    __device__ std::uint32_t count() const {
        return strips() * ((samples + samples_per_piece - 1) / samples_per_piece);
    }
    __device__ Items items(std::uint32_t piece) const {
        const std::uint32_t done = piece / strips() * samples_per_piece;
        const std::uint32_t rest = samples - done;
        const std::uint32_t rounds = samples_per_piece < rest ? samples_per_piece : rest;
        return {warp_size * rounds,  pixels, width, pt::PixelPlace::of(piece % strips() * warp_size, width),
                first_sample + done, 1};
    }
};

// Items given to a warp: numbers first to first + count - 1 of `items`; fewer than the warp asks for at a piece's end.
struct GivenItems {
    Items items;
    std::uint32_t first, count;
    bool is_exhausted;  // no items are left, and later calls get none either
};

class BlockItems {
public:
    // Starts a block without items. Every thread of the block must call it, and synchronise before any takes items.
    __device__ void begin() {
        if (threadIdx.x == 0) {
            locked_ = next_ = 0;
            items_ = {};
        }
    }

    // Takes up to `wanted` items for the warp. Every lane must call it, with the same number.
    __device__ GivenItems take(const Pieces& pieces, std::uint32_t wanted) {
        pt::cuda::acquire(locked_);
        GivenItems given{items_, next_, 0, false};
        if (given.first == given.items.count) {
            const std::uint32_t piece = take_piece(pieces.next);
            given.is_exhausted = piece >= pieces.count();
            if (!given.is_exhausted) {
                given.items = pieces.items(piece);
                given.first = 0;
            }
        }
        const std::uint32_t rest = given.items.count - given.first;
        given.count = wanted < rest ? wanted : rest;
        __syncwarp();
        if (pt::cuda::lane() == 0) {
            items_ = given.items;
            next_ = given.first + given.count;
        }
        pt::cuda::release(locked_);
        return given;
    }

private:
    __device__ static std::uint32_t take_piece(std::uint64_t* next) {
        unsigned long long taken = 0;
        if (pt::cuda::lane() == 0) {
            taken = atomicAdd(reinterpret_cast<unsigned long long*>(next), 1ull);
        }
        return static_cast<std::uint32_t>(__shfl_sync(pt::cuda::all_lanes, taken, 0));
    }

    Items items_;
    std::uint32_t next_;
    std::uint32_t locked_;
};
