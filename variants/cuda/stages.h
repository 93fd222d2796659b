// The queue of a wavefront on the device, and what compactions and sorts do to it between two stages. Host side: what
// is called here enqueues work on a stream.
#pragma once

#include <functional>
#include <string_view>

#include "variants/cuda/runtime/arena.h"
#include "variants/cuda/runtime/module.h"
#include "variants/cuda_hooks.h"

namespace pt::cuda {

// The paths in play are slots 0..count-1, or, if `indirect`, the slots order[0..count-1] in that order. `count` lies on
// the device; the host knows a bound on it, which is the count itself after a choice that waits for the device.
struct Queue {
    PathStore paths;
    PathStore spare;                       // second path store of equal size, for compactions and sorts that move paths
    void* hits = nullptr;                  // StoredHit<Real> by slot of the path, valid between intersect and shade
    void* hits_spare = nullptr;            // second array of hits, for sorts that move paths
    std::uint32_t* order = nullptr;        // slots of paths by queue position, with `capacity` entries
    std::uint32_t* order_spare = nullptr;  // second array of slots with `capacity` entries, for sorts and compactions
    std::uint32_t* keys = nullptr;         // sort keys by position in play, `capacity` entries; for sorts alone
    std::uint32_t* keys_spare = nullptr;   // second array of sort keys, with `capacity` entries
    std::uint32_t* count = nullptr;        // number of paths in play, in device memory
    std::uint32_t* count_spare = nullptr;  // second counter of paths in play, in device memory
    std::uint32_t bound = 0;               // upper bound on the number of paths in play
    bool indirect = false;
    std::uint32_t capacity = 0;                   // number of path slots of the queue
    const unsigned char* object_class = nullptr;  // class of each object, on the device: 0 diffuse-like, 1 delta-like

    void swap_order() { std::swap(order, order_spare); }
    void swap_paths() { std::swap(paths, spare); }
    void swap_hits() { std::swap(hits, hits_spare); }
    void swap_count() { std::swap(count, count_spare); }
};

// Threads per block in the kernels of compactions and sorts that NVRTC compiles.
inline constexpr std::uint32_t stage_block = 256;
constexpr std::uint32_t blocks_for(std::uint32_t threads) { return (threads + stage_block - 1) / stage_block; }

// The cell that a compaction or sort is made for: layout, precision, scene, stream and tunables.
struct CellContext {
    const Layout* layout = nullptr;
    std::string_view layout_name;
    std::size_t real_bytes = 4;
    std::uint32_t materials = 0;
    std::uint32_t multiprocessors = 1;
    cudaStream_t stream = nullptr;
    std::function<std::uint32_t(std::string_view)> tunable;
    // Kernels of the choice (Hooks::kernels), from the source of its name (variants/compaction/NAME.cuh), compiled for
    // the cell's layout, precision and GPU.
    std::function<const Module&()> module;
    // Counters of the kernels that the choice enqueues, and of its waits for the device.
    std::uint64_t* launches = nullptr;
    std::uint64_t* host_waits = nullptr;
};

// Bytes of a path that compactions and sorts read or move.
struct BytesOfAPath {
    double state = 0;     // the fields that the scene's kernels write
    double liveness = 0;  // what is read of it to learn whether it is alive: the field, or a sector of memory with it
    double hit = 0;       // its stored hit; 0: none is stored
};

// The bytes that a pass over the queue reads and writes at least, whoever does it: a bound of its time. All 0: unknown.
struct LeastBytes {
    double a_path = 0;      // for each path in play before the pass
    double a_survivor = 0;  // for each path in play after it, in addition
    double a_listed = 0;    // for each path in play before any pass but the first: what the pass before listed

    bool is_known() const { return a_path > 0; }
};

inline constexpr double slot_bytes = sizeof(std::uint32_t), key_bytes = sizeof(std::uint32_t);

// A compaction on the device: takes the ended paths out of play, between two bounces.
class Compaction {
public:
    virtual ~Compaction() = default;
    // Takes device memory beyond the queue's; called with a measuring arena first, then with one that has the memory.
    // Every pointer of the queue but its counts is null in the first call.
    virtual void reserve(Arena&, const Queue&) {}
    // Enqueues the compaction. Afterwards *queue.count paths are in play, and queue.bound is at least their number.
    virtual void compact(Queue& queue) = 0;
    virtual bool needs_spare_paths() const { return false; }
    // Whether the compaction copies whole paths, in which case a store must have room for every field of a path.
    virtual bool moves_paths() const { return true; }
    // A compaction of slot numbers writes those of the survivors, which the next one reads. One of paths has read what
    // tells of their liveness when it reads the rest.
    virtual LeastBytes least_bytes(const BytesOfAPath& path) const {
        return moves_paths() ? LeastBytes{path.liveness, 2 * path.state - path.liveness, 0}
                             : LeastBytes{path.liveness, slot_bytes, slot_bytes};
    }
};

// A part of the queue that one launch shades: the paths in slots order[0..*count-1]. Null order: the queue's own.
struct ShadeRange {
    const std::uint32_t* order = nullptr;
    const std::uint32_t* count = nullptr;
};

// A sort on the device: brings paths of equal key together before they are shaded (or, with a ray key, before they are
// traced).
class Sorting {
public:
    virtual ~Sorting() = default;
    virtual void reserve(Arena&, const Queue&) {}
    // Enqueues a sort by queue.keys, whose keys are below key_count for positions in play, and key_count - 1 for all
    // other positions below queue.bound.
    virtual void sort(Queue& queue, std::uint32_t key_count) = 0;
    // The ranges of the queue to shade, one launch each; empty: one launch over the whole queue.
    virtual std::vector<ShadeRange> shade_ranges() const { return {}; }
    // Whether the sort copies whole paths, in which case a store must have room for every field of a path.
    virtual bool moves_paths() const { return true; }
    // Whether it copies them and their hits into the spare ones.
    virtual bool needs_spare_paths() const { return false; }
    LeastBytes least_bytes(const BytesOfAPath& path) const {
        return {key_bytes + (moves_paths() ? 2 * (path.state + path.hit) : slot_bytes), 0, 0};
    }
};

}  // namespace pt::cuda
