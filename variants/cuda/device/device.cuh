// Common header of all kernels that NVRTC compiles: the types of the variant, and sums over a thread block.
// The program's text (program_text in variants/cuda/runtime/module.cpp) begins with what the host has chosen: Real,
// kernel_config, the layout (Paths), the accelerator, where the scene's arrays lie; and goes on with the sort key.
#pragma once

#include "variants/cuda/device/kernel_config.h"
#include "variants/cuda/device/kernel_parameters.h"
#include "variants/cuda/device/parameters.h"
#include "variants/cuda/device/path_store.h"
#include "variants/cuda/device/warp_reduce.cuh"

// Declares a kernel, with its parameters in brackets: it compiles only if they match the host's launch in number, type
// and size. Only the host has them as one struct: a kernel loads a struct's members from elsewhere than parameters, and
// has other registers. host_bytes is in the program's text.
#define PT_KERNEL_WITH(bounds, name, Parameters, ...)                                                      \
    extern "C" __global__ void bounds name __VA_ARGS__;                                                    \
    static_assert(pt::cuda::is_kernel_of<Parameters, decltype(name)>(#name), "not the host's parameters"); \
    static_assert(sizeof(Parameters) == host_bytes::name, "not of the size that the host knows");          \
    extern "C" __global__ void bounds name __VA_ARGS__
#define PT_KERNEL(...) PT_KERNEL_WITH(__launch_bounds__(kernel_config.block, kernel_config.min_blocks), __VA_ARGS__)
// Declares a kernel that is launched in blocks of any size, and gets as many registers as that leaves.
#define PT_UNBOUNDED_KERNEL(...) PT_KERNEL_WITH(, __VA_ARGS__)

struct Configuration : pt::Config<Real, kernel_config.features, Accelerator> {
    static constexpr bool has_one_light = kernel_config.counts.one_light != pt::cuda::FixedCounts::none;
};
using Scene = pt::SceneView<Real>;
using Path = pt::Path<Real>;
using Hit = pt::Hit<Real>;
using StoredHit = pt::StoredHit<Real>;
// Counters of one thread, in 32 bits: lest they overflow, the host splits longer renders into several launches, or the
// kernel adds the counters up in between.
using ThreadCounters = pt::PathCountersOf<std::uint32_t>;
using HitCache = pt::cuda::HitCache<Real>;
using pt::FilmView;
using pt::cuda::PathStore;
using pt::cuda::SegmentCounts;
using pt::cuda::SegmentNumber;
using pt::cuda::Totals;
using pt::cuda::warp_size;

namespace pt::cuda {

__device__ inline std::uint32_t lane() { return threadIdx.x % warp_size; }
// Rank of the calling lane among the lanes of the mask `lanes`: the number of these that are below it.
__device__ inline std::uint32_t rank_in(unsigned lanes) {
    return static_cast<std::uint32_t>(__popc(lanes & ((1u << lane()) - 1u)));
}
__device__ inline std::uint32_t thread_number() { return blockIdx.x * blockDim.x + threadIdx.x; }
__device__ inline std::uint32_t thread_count() { return gridDim.x * blockDim.x; }

// Takes the next number of a counter in global memory, one for the warp. Every lane must call it.
__device__ inline std::uint32_t take_number(std::uint64_t* counter) {
    unsigned long long taken = 0;
    if (lane() == 0) {
        taken = atomicAdd(reinterpret_cast<unsigned long long*>(counter), 1ull);
    }
    return warp_sum(static_cast<std::uint32_t>(taken));
}

// Adds each thread's values to totals in global memory, with one atomic operation a block and value. Every thread of
// the block must call it, once.
template <int count>
__device__ inline void add_over_block(const std::uint32_t (&values)[count], std::uint64_t* const (&totals)[count]) {
    __shared__ std::uint32_t sums[count];
    if (threadIdx.x < count) {
        sums[threadIdx.x] = 0;
    }
    __syncthreads();
    for (int i = 0; i < count; ++i) {
        const std::uint32_t sum = warp_sum(values[i]);
        if (lane() == 0 && sum != 0) {
            atomicAdd(&sums[i], sum);
        }
    }
    __syncthreads();
    for (int i = 0; i < count; ++i) {
        if (threadIdx.x == static_cast<unsigned>(i) && sums[i] != 0) {
            atomic_add(totals[i], static_cast<std::uint64_t>(sums[i]));
        }
    }
}

// The copy of the totals that the thread block adds to: blocks that added to one address would wait for each other.
__device__ inline Totals* own_copy(Totals* totals) { return totals + blockIdx.x % counter_copies; }

// Adds to a total in global memory how many threads of the block say yes. Every thread must call it.
__device__ inline void add_votes(std::uint64_t* total, bool vote) {
    const int votes = __syncthreads_count(vote ? 1 : 0);
    if (threadIdx.x == 0 && votes != 0) {
        atomic_add(total, static_cast<std::uint64_t>(votes));
    }
}

// Adds up the counts of a kernel that shades one segment a thread: whether the thread's path ended and, in kernels that
// may have them, connections and unfinished walks. The number of rays follows from that of paths traced. Every thread
// of the block must call it.
__device__ inline void add_shade_counters(Totals* totals, const ThreadCounters& counters) {
    Totals* const mine = own_copy(totals);
    add_votes(&mine->paths.paths, counters.paths != 0);
    if constexpr (has<Configuration>(Feature::final_bounce) || has<Configuration>(Feature::next_event) ||
                  has<Configuration>(Feature::subsurface)) {
        add_votes(&mine->paths.connections, counters.connections != 0);
        add_votes(&mine->paths.unfinished_walks, counters.unfinished_walks != 0);
    }
}

// Counts how many paths of a kernel that traces one segment a thread are alive, and how many are in play. Every thread
// of the block must call it.
__device__ inline void add_segment_counts(const SegmentCounts& segments, std::uint32_t segment, bool live,
                                          std::uint32_t in_play) {
    const std::size_t copy = static_cast<std::size_t>(segment) * segments.copies + blockIdx.x % segments.copies;
    add_votes(&segments.live[copy], live);
    if (thread_number() == 0) {
        atomic_add(&segments.in_play[copy], static_cast<std::uint64_t>(in_play));
    }
}

// Adds what a thread has counted to the totals once it is more than a block can add up, and starts its counts anew.
__device__ inline void add_if_many(Totals* totals, ThreadCounters& counters) {
    if (counters.rays + counters.paths < few_rays) {
        return;
    }
    Totals* const mine = own_copy(totals);
    const auto add = [](std::uint64_t& total, std::uint32_t count) { atomic_add(&total, std::uint64_t{count}); };
    add(mine->paths.paths, counters.paths);
    add(mine->paths.rays, counters.rays);
    add(mine->paths.connections, counters.connections);
    add(mine->paths.unfinished_walks, counters.unfinished_walks);
    add(mine->cache_uses, kernel_config.keeps_first_hits ? counters.paths : 0);
    counters = {};
}

__device__ inline void add_counters(Totals* totals, const ThreadCounters& counters, std::uint32_t cache_uses) {
    const std::uint32_t values[] = {counters.paths, counters.rays, counters.connections, counters.unfinished_walks,
                                    cache_uses};
    Totals* const mine = own_copy(totals);
    std::uint64_t* const sums[] = {&mine->paths.paths, &mine->paths.rays, &mine->paths.connections,
                                   &mine->paths.unfinished_walks, &mine->cache_uses};
    add_over_block(values, sums);
}

}  // namespace pt::cuda

// A scene as kernels read it: `shade` for the surface that each lane has hit, `trace` for all objects in turn. A kernel
// has copies of both, of which little remains: where the variant fixes the numbers of objects, they are constants.
struct OwnSceneViews {
    Scene shade, trace;

    __device__ explicit OwnSceneViews(const Scene& scene) : shade(scene), trace(scene) {
        if constexpr (kernel_config.has_fixed_counts) {
            fix_counts(shade);
        }
        if constexpr (Configuration::has_one_light) {
            static constexpr pt::Light light{kernel_config.counts.one_light};
            shade.lights = {&light, 1};
        }
        pt::cuda::bake(shade);
        trace = shade;
        pt::cuda::place_traced_arrays(trace);
        if constexpr (kernel_config.has_fixed_counts) {
            share_single_shapes();
        }
    }

private:
    // Lets shading read a kind of shape with a single object from where tracing reads it: all lanes read the same
    // numbers then.
    __device__ void share_single_shapes() {
#define PT_SHARE(name, kind, word)                   \
    if constexpr (kernel_config.counts.name == 1u) { \
        shade.name.data = trace.name.data;           \
    }
        PT_OBJECT_ARRAYS(PT_SHARE)
#undef PT_SHARE
    }
    __device__ static void fix_counts(Scene& scene) {
        constexpr pt::cuda::FixedCounts counts = kernel_config.counts;
#define PT_FIX(name, kind, word) scene.name.size = counts.name;
#define PT_FIX_BY_OBJECT(name, kind, word) scene.name.size = counts.objects();
        PT_OBJECT_ARRAYS(PT_FIX)
        PT_TRACED_ARRAYS(PT_FIX_BY_OBJECT)
        PT_SHADING_ARRAYS(PT_FIX_BY_OBJECT)
#undef PT_FIX
#undef PT_FIX_BY_OBJECT
        scene.enclosure.walls = counts.walls;
        scene.enclosure.lamps = counts.lamps;
        scene.enclosure.open_sides = counts.open_sides;
        for (int axis = 0; axis < 3; ++axis) {
            scene.enclosure.low_side[axis].code = counts.low_sides[axis];
            scene.enclosure.high_side[axis].code = counts.high_sides[axis];
        }
    }
};

// The scene of a kernel with all features. Its functions are too large to be inlined, and copies of the scene would be
// handed to them in each thread's local memory. So the kernel reads the parameter in place, and each block keeps one
// copy, for tracing, in shared memory: as bytes, since shared variables have no constructor.
struct SharedSceneViews {
    const Scene &shade, &trace;

    // Copies the scene for tracing to the block's shared memory. Every thread of the block must call it, once in a
    // kernel.
    __device__ explicit SharedSceneViews(const Scene& scene) : shade(scene), trace(traced(scene)) {}

private:
    __device__ static const Scene& traced(const Scene& scene) {
        alignas(Scene) __shared__ unsigned char memory[sizeof(Scene)];
        Scene& placed = *reinterpret_cast<Scene*>(memory);
        if (threadIdx.x == 0) {
            placed = scene;
            pt::cuda::place_traced_arrays(placed);
        }
        __syncthreads();
        return placed;
    }
};

inline constexpr bool shares_scene = !kernel_config.has_fixed_counts && !pt::cuda::bakes_scene;
using SceneViews = std::conditional_t<shares_scene, SharedSceneViews, OwnSceneViews>;
// Bytes of a block's shared memory that the scene's copy takes.
inline constexpr std::size_t scene_bytes_shared = shares_scene ? sizeof(Scene) : 0;

// The fields that a path carries between two bounces in this variant.
inline constexpr pt::PathFields carried_fields = pt::PathFields::of(Configuration::features);

// Reads a path from the queue. A field that this variant does not carry is not read: it has the value that all paths
// have.
__device__ inline Path load_path(const Paths& paths, std::uint32_t slot, const Scene& scene) {
    using namespace pt;
    ::Path path = paths.load(slot);
#define PT_SET(name, type, change, features, value) \
    if constexpr (!carried_fields.name) {           \
        path.name = value;                          \
    }
    PT_PATH_FIELDS(PT_NO_FIELD, PT_SET)
#undef PT_SET
    return path;
}

// Start of a path: the sample's own camera ray or, with a first-bounce cache, the cached one that it uses.
__device__ inline Path first_path(const Scene& scene, const pt::PixelPlace& place, std::uint32_t sample,
                                  const HitCache& cache) {
    return pt::generate<Configuration>(scene, place, sample,
                                       kernel_config.keeps_first_hits ? sample % cache.rays : sample);
}

__device__ inline Path first_path(const Scene& scene, std::uint32_t pixel, std::uint32_t sample,
                                  const HitCache& cache) {
    return first_path(scene, pt::PixelPlace::of(pixel, scene.camera.width), sample, cache);
}

__device__ inline Hit trace(const SceneViews& scene, const Path& path) {
    return pt::intersect<Configuration>(scene.trace, path);
}

__device__ inline Hit first_hit(const SceneViews& scene, const Path& path, const HitCache& cache) {
    if (kernel_config.keeps_first_hits) {
        return cache.load<Configuration>(cache.index(path.pixel, path.sample));
    }
    return trace(scene, path);
}

// The hit of the path's current segment: traced or, for the first segment, from the first-bounce cache if there is one.
__device__ inline Hit next_hit(const SceneViews& scene, const Path& path, const HitCache& cache) {
    return kernel_config.keeps_first_hits && path.segment == 0 ? first_hit(scene, path, cache) : trace(scene, path);
}

// Injects the cost of a costlier material: kernel_config.shading_fmas dependent multiply-adds, executed material by
// material, so that a warp whose lanes hit k materials pays for k. The path depends on the result as far as ptxas can
// tell (it drops unused inline assembly, volatile or not): x starts at 0 or above and never falls, so it is never below
// 0 in fact.
__device__ inline void injected_cost(const Scene& scene, const Hit& hit, Path& path) {
    if constexpr (kernel_config.shading_fmas > 0) {
        const std::uint32_t mine = hit.side.exists() ? scene.object_material[hit.side.object()] : 0xffffffffu;
        for (std::uint32_t material = 0; material < scene.materials.size; ++material) {
            if (mine == material) {
                float x = path.throughput.x < Real(0) ? 1.0f : 0.0f;
                for (int i = 0; i < static_cast<int>(kernel_config.shading_fmas); ++i) {
                    asm volatile("fma.rn.f32 %0, %0, %0, %0;" : "+f"(x));
                }
                if (x < 0.0f) {
                    path.throughput.x = Real(0);
                }
            }
        }
    }
}

__device__ inline bool shade(const SceneViews& scene, Path& path, const Hit& hit, ThreadCounters& counters) {
    injected_cost(scene.shade, hit, path);
    return pt::shade<Configuration>(scene.shade, scene.trace, path, hit, counters);
}

// Shades the hit of a path; a subsurface walk that begins there is left to the caller, or taken to its end.
template <bool leaves_walks>
__device__ inline bool shade(const SceneViews& scene, Path& path, const Hit& hit, ThreadCounters& counters,
                             pt::WalkOf<Configuration>& walk) {
    if constexpr (leaves_walks) {
        injected_cost(scene.shade, hit, path);
        return pt::shade<Configuration>(scene.shade, scene.trace, path, hit, counters, walk);
    } else {
        return shade(scene, path, hit, counters);
    }
}

// One step of a path: of its subsurface walk, if it is on one, else its segment is traced and shaded. A warp whose
// lanes take their walks step by step does not wait for the longest of them. Returns whether the path lives.
__device__ inline bool take_step(const SceneViews& scene, Path& path, pt::WalkOf<Configuration>& walk,
                                 const HitCache& cache, ThreadCounters& counters) {
    if constexpr (pt::has<Configuration>(pt::Feature::subsurface)) {
        if (walk.is_on()) {
            return pt::walk_on<Configuration>(scene.shade, path, walk, counters);
        }
    }
    const Hit hit = next_hit(scene, path, cache);
    injected_cost(scene.shade, hit, path);
    return pt::shade<Configuration>(scene.shade, scene.trace, path, hit, counters, walk);
}
