// Renders a scene with a variant and returns the film, the work done and the time taken.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "harness/render/film.h"
#include "harness/scene/scene_buffers.h"
#include "variants/registry.h"

namespace pt {

// The state of a render after some of its samples; valid only during the callback.
struct Checkpoint {
    std::uint32_t samples = 0;  // samples per pixel rendered so far
    double wall_ms = 0;         // times in ms so far, as in RenderResult, without those of callbacks
    double device_ms = 0;
    double cpu_ms = 0;
    const Film& film;  // film of the samples so far, at the scale of the whole render
};

struct RenderRequest {
    Variant variant;
    Backend backend = Backend::cpu;
    RenderSettings settings;  // render settings; those that follow from the variant are replaced (settings_for)
    std::uint32_t first_sample = 0;
    std::uint32_t samples = 1;  // samples per pixel to render
    bool instrument = false;    // measures stages and live paths, which falsifies the render's time
    // Samples per pixel of the finished film, if this render adds only a part of them; 0: as many as `samples`.
    std::uint32_t film_samples = 0;
    // Samples after which the render stops to call `on_checkpoint`: increasing, the last one == samples; empty: no
    // stops. Stops change neither the film's bits (except where stops_change_film) nor the counters; a first-bounce
    // cache is filled once, and queues with several samples per pixel end their batches at checkpoints.
    std::vector<std::uint32_t> checkpoints = {};
    std::function<void(const Checkpoint&)> on_checkpoint = {};
};

// The preparation of a render on CUDA before its clock starts, and the compiler's resource usage of its kernels.
struct CudaFacts {
    struct Kernel {
        std::string name;
        int registers = 0;             // the kernel's registers per thread
        std::size_t local_bytes = 0;   // bytes of local memory per thread: spills and arrays
        std::size_t shared_bytes = 0;  // bytes of shared memory per thread block
    };
    double compile_seconds = 0;        // time spent in NVRTC or on reading the kernel cache
    bool from_cache = false;           // whether all modules were in the kernel cache or loaded already
    double prepare_ms = 0;             // set-up time: allocation, upload and CUDA graph capture
    std::size_t device_bytes = 0;      // device memory that the render uses: arena, and meshes with their trees
    std::size_t path_bytes = 0;        // device memory per path in the queue, including compaction and sorting
    std::size_t path_state_bytes = 0;  // part of `path_bytes`: one copy of a path's state
    std::uint32_t threads = 0;         // threads per thread block
    std::vector<Kernel> kernels;
    std::vector<std::string> options;  // options of the kernel compiler

    // Adds the compile time of an earlier render of the same variant in this process to these facts.
    void add_compilation(const CudaFacts& earlier) {
        compile_seconds += earlier.compile_seconds;
        from_cache = from_cache && earlier.from_cache;
    }
};

// Facts of a render on several devices; for a single device `count` is 1 and all else empty.
struct DeviceFacts {
    std::uint32_t count = 1;
    // For each device the time from the common start until its share is rendered, without summing films; 0 if idle.
    std::vector<double> own_ms;
    double slowest_ms = 0;  // time from the common start until the last device has rendered its share
    double reduce_ms = 0;   // time that summing all films on the first device takes after slowest_ms
};

struct RenderResult {
    Film film;
    WorkCounters work;
    StageTimes stages;
    FeatureSet needed = no_features;    // features needed by scene and variant
    FeatureSet compiled = no_features;  // features compiled into the kernel that ran
    double wall_ms = 0;          // render time from the first stage to the last, without callbacks at checkpoints
    double device_ms = 0;        // time on the device; equal to wall_ms on the CPU backend
    double cpu_ms = 0;           // CPU time of all threads during wall_ms
    CudaFacts cuda = {};         // facts of a render on CUDA
    MeshFacts meshes = {};       // facts about meshes; zero triangles if the scene has none
    HealthCounters health = {};  // health counters; zero paths if the integrator keeps none
    DeviceFacts devices = {};    // facts of several devices: wall_ms is slowest_ms + reduce_ms + learning for roulette
};

// The kernel with which a variant renders a scene: the features needed, and those compiled into the kernel.
struct KernelChoice {
    FeatureSet needed, compiled;
    RenderFunction render;                        // render function on the CPU backend
    RenderIn<double> render_in_double = nullptr;  // function for precision=double on the CPU, in place of `render`
    // How well the kernel fits the scene: "exact", or "has .. for nothing" with the features that the scene lacks.
    std::string note() const;
};
KernelChoice choose_kernel(const Scene& scene, const Variant& variant, Backend backend = Backend::cpu);

// Number of triangles of all objects; a mesh shown by several objects counts several times.
std::uint64_t triangles_of(const Scene& scene);
std::ptrdiff_t objects_with_meshes(const Scene& scene);

// Largest number of triangles for which brute force, testing each triangle in turn, is the reference accelerator.
inline constexpr std::uint64_t most_by_brute_force = 100'000;
// The variant whose film this variant must equal bit for bit on a scene (Registry::reference). For scenes with more
// than most_by_brute_force triangles, accelerators are compared with one of themselves.
Variant reference_on(const Scene& scene, const Variant& variant, Backend backend);
// The variants that verification renders: the given one, its exact twin, its reference, and those of claims on means.
std::vector<Variant> rendered_to_check(const Scene& scene, const Variant& variant, Backend backend);
// Largest number of objects with meshes for which testing each in turn is the reference; beyond, a tree over them is.
inline constexpr std::ptrdiff_t most_objects_in_turn = 16;
// The reference variant for films that take long to render: with a tree accelerator wherever there are meshes.
Variant fast_reference_on(const Scene& scene, const Variant& variant, Backend backend);

// A CPU accelerator that is fast on large meshes; all accelerators give the same hits.
Acceleration quick_acceleration(const Scene& scene);

// The settings of a render request, completed by what its variant determines.
RenderSettings settings_for(const RenderRequest& request, const KernelChoice& kernel);

// Data on a scene for inspecting integrators, without counters; `file_index` maps object numbers to Scene::objects.
HealthRequest health_request(const Scene& scene, const std::vector<std::uint32_t>& file_index);

// Renders the request. Precondition: why_not_applicable(variant, features) is empty. Throws MachineError if memory runs
// out, and std::logic_error for invalid checkpoints (parts_of).
RenderResult render(const Scene& scene, const RenderRequest& request);

// The function that renders on the CUDA backend, which harness/cuda/ registers before main() so that harness/render/
// does not depend on it. `set_cuda_render` returns true.
using RenderRequested = RenderResult (*)(const Scene& scene, const RenderRequest& request);
bool set_cuda_render(RenderRequested render);
// Describes a render, as "wavefront on cornell_open, cpu, 64x64, 4 spp, seed 1".
std::string description_of(const Scene& scene, const RenderRequest& request);
// Calls render() such that a crash report names the render (harness/crash.h). Making the description takes
// microseconds, so timed samples call render() and are described before their clock starts.
RenderResult render_named(const Scene& scene, const RenderRequest& request);

}  // namespace pt
