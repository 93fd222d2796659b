// An integrator on CUDA: made for a cell, it owns its buffers and knows its tunables; what every integrator is handed
// is in job.h.
#pragma once

#include <map>
#include <memory>
#include <string_view>
#include <utility>
#include <vector>

#include "variants/cuda/device/key_bounds.h"
#include "variants/cuda/job.h"
#include "variants/registry.h"

namespace pt::cuda {

// Bytes of device memory that one path in a queue takes.
struct PathBytes {
    std::size_t state = 0;       // bytes of one copy of a path itself
    std::size_t everything = 0;  // bytes of a path with its share of all memory of the queue
};

// What the passes over a queue between two of the integrator's kernels read and write at least.
struct LeastTraffic {
    std::map<std::string_view, LeastBytes> by_stage = {};  // by the stage in which a pass is timed
    std::uint32_t samples_in_flight = 1;                   // samples of each pixel that a pass covers
};

class Integrator {
public:
    virtual ~Integrator() = default;
    Integrator() = default;
    Integrator(const Integrator&) = delete;
    Integrator& operator=(const Integrator&) = delete;

    // Takes the integrator's device memory; called with a measuring arena first, then with one that has the memory.
    virtual void reserve(Arena&) {}
    // Brings the memory that reserve() took into the state in which a render begins. May wait for the device.
    virtual void upload() {}
    // Captures launches that can be replayed (CUDA graphs), before the clock starts.
    virtual void prepare() {}
    // Enqueues the job's samples on its stream.
    virtual void render() = 0;
    // Returns work counters that only the device knows; waits for the device.
    virtual WorkCounters device_work() const { return {}; }
    virtual PathBytes path_bytes() const { return {}; }
    virtual LeastTraffic least_traffic() const { return {}; }
};

// What an integrator on CUDA is made from, besides the job: variant, choices on its queue, facts of the scene.
struct IntegratorNeeds {
    Variant variant;
    VariantTraits traits;
    FeatureSet features = no_features;  // features that the integrator's kernels have
    KeyBounds key_bounds;               // bounds of the scene's positions, for sort keys
    // The queue's memory layout and the choices that work on the queue; only integrators with a queue use them.
    Layout layout = {};
    std::vector<unsigned char> object_class = {};      // class of each object: 0 diffuse-like, 1 delta-like
    std::unique_ptr<Compaction> compaction = nullptr;  // compaction stage; null: the queue is not compacted
    std::unique_ptr<Sorting> sorting = nullptr;        // sorting stage; null: the queue is not sorted

    std::uint32_t tunable(std::string_view name) const { return pt::tunable(variant, name, Backend::cuda); }
};

// Part of an integrator's program: the kernel that has Parameters<Real> and whose text is in `source`.
template <template <class Real> class Parameters>
constexpr KernelPart kernel_part(const char* source) {
    return {source, kernel_of<Parameters<float>>(), kernel_of<Parameters<double>>()};
}

// Hook that makes an integrator: by Class<Real>(JobOf<Real>&, IntegratorNeeds&&), with kernels Class<Real>::kernels().
template <template <class Real> class Class>
IntegratorHook integrator_hook() {
    return {.make_single = [](JobOf<float>& job, IntegratorNeeds&& needs) -> std::unique_ptr<Integrator> {
                return std::make_unique<Class<float>>(job, std::move(needs));
            },
            .make_double = [](JobOf<double>& job, IntegratorNeeds&& needs) -> std::unique_ptr<Integrator> {
                return std::make_unique<Class<double>>(job, std::move(needs));
            },
            .single_kernels = &Class<float>::kernels,
            .double_kernels = &Class<double>::kernels};
}

}  // namespace pt::cuda
