// Renders one variant of one scene and says what it did and how long it took.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "harness/render/film.h"
#include "harness/scene/scene_buffers.h"
#include "variants/registry.h"

namespace pt {

// A render's state after some of its samples; valid during the call only.
struct Checkpoint {
    std::uint32_t samples = 0;  // a pixel, so far
    double wall_ms = 0;         // so far, as in RenderResult; what happens at checkpoints is not in them
    double device_ms = 0;
    double cpu_ms = 0;
    const Film& film;  // of the samples so far, at the whole render's scale: film.samples() == samples
};

struct RenderRequest {
    Variant variant;
    Backend backend = Backend::cpu;
    RenderSettings settings;  // what the variant decides is set by it (settings_for)
    std::uint32_t first_sample = 0;
    std::uint32_t samples = 1;  // a pixel
    bool instrument = false;    // take stage times and live paths; such a render's time is no result
    // Samples that the whole film is for, if this render adds only a part of them; 0: `samples`.
    std::uint32_t film_samples = 0;
    // Samples after which the render stops to call `on_checkpoint`: increasing, the last one == samples; empty: it
    // runs in one part. The film's bits (but stops_change_film) and what is counted are the same either way; a
    // first-bounce cache is filled once, and a queue of several samples a pixel has batches that end at checkpoints.
    std::vector<std::uint32_t> checkpoints = {};
    std::function<void(const Checkpoint&)> on_checkpoint = {};
};

// What a render on CUDA had to do before its clock started, and what the compiler made of its kernels.
struct CudaFacts {
    struct Kernel {
        std::string name;
        int registers = 0;             // a thread
        std::size_t local_bytes = 0;   // a thread: spills and arrays
        std::size_t shared_bytes = 0;  // a block
    };
    double compile_seconds = 0;        // NVRTC, or reading the cache
    bool from_cache = false;           // every module came from the cache on disk or was loaded already
    double prepare_ms = 0;             // memory, upload and graph
    std::size_t device_bytes = 0;      // the cell's arena
    std::size_t path_bytes = 0;        // of device memory a path in the queue, with all that compacts and sorts it
    std::size_t path_state_bytes = 0;  // of that, one copy of the path itself
    std::uint32_t threads = 0;         // a block
    std::vector<Kernel> kernels;
    std::vector<std::string> options;  // for the compiler

    // Adds what an earlier render of the same variant in this process had to compile.
    void add_compilation(const CudaFacts& earlier) {
        compile_seconds += earlier.compile_seconds;
        from_cache = from_cache && earlier.from_cache;
    }
};

// What several devices add to a render's facts; of one device `count` is 1 and all else empty.
struct DeviceFacts {
    std::uint32_t count = 1;
    // Time of each device from the common start to the end of its own work, without the reduction; 0: it had none.
    std::vector<double> own_ms;
    double slowest_ms = 0;  // from the common start until the last one had rendered
    double reduce_ms = 0;   // from there until the first device had the sum of the films
};

struct RenderResult {
    Film film;
    WorkCounters work;
    StageTimes stages;
    FeatureSet needed = no_features;    // by scene and variant
    FeatureSet compiled = no_features;  // in the kernel that ran
    double wall_ms = 0;                 // from the first stage to the end of the last, less what checkpoints took
    double device_ms = 0;               // on the CPU backend the same
    double cpu_ms = 0;                  // CPU time of all threads over the same span
    CudaFacts cuda = {};                // of a render on CUDA
    MeshFacts meshes = {};              // of a scene that has some; else no triangles
    HealthCounters health = {};         // of an integrator that inspects its paths; else no paths
    DeviceFacts devices = {};  // of several; wall_ms is slowest_ms and reduce_ms, after what a roulette learned
};

// The kernel that a variant runs for a scene: what is needed, and what the kernel that was compiled contains.
struct KernelChoice {
    FeatureSet needed, compiled;
    RenderFunction render;                        // CPU
    RenderIn<double> render_in_double = nullptr;  // CPU with precision=double: this one instead
    // How the kernel fits the scene: "exact", or "has .. for nothing" with the features that the scene does not need.
    std::string note() const;
};
KernelChoice choose_kernel(const Scene& scene, const Variant& variant, Backend backend = Backend::cpu);

// Triangles of all objects together: those of a mesh that several objects show count again.
std::uint64_t triangles_of(const Scene& scene);
std::ptrdiff_t objects_with_meshes(const Scene& scene);

// Triangles of all objects together up to which every triangle in turn is the reference of meshes.
inline constexpr std::uint64_t most_by_brute_force = 100'000;
// The variant that this one must equal bit for bit on a scene (Registry::reference). Beyond most_by_brute_force
// accelerators are held against one of themselves.
Variant reference_on(const Scene& scene, const Variant& variant, Backend backend);
// The variants that verification renders: the variant, its exact twin, the reference, and what claims of a mean are
// held to.
std::vector<Variant> rendered_to_check(const Scene& scene, const Variant& variant, Backend backend);
// Objects with meshes up to which each in turn is the reference of large scenes; beyond, a tree over them.
inline constexpr std::ptrdiff_t most_objects_in_turn = 16;
// The reference of a variant with an accelerator that has a tree, wherever there are meshes: for films that take long.
Variant fast_reference_on(const Scene& scene, const Variant& variant, Backend backend);

// Any accelerator gives the same hits: one of the CPU's that is quick on large meshes.
Acceleration quick_acceleration(const Scene& scene);

// The request's settings with what its variant asks of the kernel.
RenderSettings settings_for(const RenderRequest& request, const KernelChoice& kernel);

// What an auditing integrator is to know of a scene, without counters; `file_index` is by object number.
HealthRequest health_request(const Scene& scene, const std::vector<std::uint32_t>& file_index);

// Precondition: why_not_applicable(variant, features) is empty. Throws MachineError if memory runs out, and
// std::logic_error if the checkpoints are not as they must be.
RenderResult render(const Scene& scene, const RenderRequest& request);

// What renders requests for the CUDA backend. harness/cuda/ names it before main(), so that this room need not know
// that one. Returns true.
using RenderRequested = RenderResult (*)(const Scene& scene, const RenderRequest& request);
bool set_cuda_render(RenderRequested render);
// A render in words, as "wavefront on cornell_open, cpu, 64x64, 4 spp, seed 1".
std::string description_of(const Scene& scene, const RenderRequest& request);
// Calls render() such that a crash in it names the render (harness/crash.h). Putting the description together takes
// microseconds: a timed sample calls render() instead, and is described before its clock starts.
RenderResult render_named(const Scene& scene, const RenderRequest& request);

}  // namespace pt
