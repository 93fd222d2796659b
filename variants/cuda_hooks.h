// What a choice brings to the CUDA backend: factories, kernels, compiler options. No CUDA header is included, so that
// the registry and the CPU tests compile without a toolkit.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "variants/cuda/device/kernel_parameters.h"
#include "variants/cuda/device/path_store.h"

namespace pt {
class Variant;
}

namespace pt::cuda {

class Compaction;
class Integrator;
class Sorting;
struct CellContext;
struct IntegratorNeeds;
template <class Real>
struct JobOf;

struct Layout {
    // Size in bytes of a path store for `capacity` paths that carry `fields`; a layout may store further fields.
    std::size_t (*bytes)(std::uint32_t capacity, std::size_t real_bytes, const PathFields& fields) = nullptr;
    // Where a store keeps Path::segment and Path::origin_surface.
    FieldView (*segment)(const PathStore& store, std::size_t real_bytes) = nullptr;
    FieldView (*origin_surface)(const PathStore& store, std::size_t real_bytes) = nullptr;
};

// The layout functions of a device path store `Paths`, for both sizes of a Real, which the host knows at run time only.
template <template <class Real> class Paths>
constexpr Layout layout_hooks() {
    return {.bytes =
                [](std::uint32_t capacity, std::size_t real_bytes, const PathFields& fields) {
                    return real_bytes == sizeof(float) ? Paths<float>::bytes(capacity, fields)
                                                       : Paths<double>::bytes(capacity, fields);
                },
            .segment =
                [](const PathStore& store, std::size_t real_bytes) {
                    return real_bytes == sizeof(float) ? Paths<float>(store).segment() : Paths<double>(store).segment();
                },
            .origin_surface =
                [](const PathStore& store, std::size_t real_bytes) {
                    return real_bytes == sizeof(float) ? Paths<float>(store).origin_surface()
                                                       : Paths<double>(store).origin_surface();
                }};
}

// A compile-time constant of an integrator's kernels, which their program reads as tuned::NAME.
struct KernelConstant {
    std::string name;
    std::uint32_t value = 0;
};

// A source file of the device's code with one further kernel, which only some of an integrator's programs contain.
struct KernelPart {
    const char* source = nullptr;  // embedded source file of the kernel; null: the integrator has no such kernel
    KernelSignature single_kernel = {};
    KernelSignature double_kernel = {};
};

// What NVRTC compiles for an integrator, and how the integrator is made for a cell.
struct IntegratorHook {
    std::unique_ptr<Integrator> (*make_single)(JobOf<float>& job, IntegratorNeeds&& needs) = nullptr;
    std::unique_ptr<Integrator> (*make_double)(JobOf<double>& job, IntegratorNeeds&& needs) = nullptr;
    std::vector<KernelSignature> (*single_kernels)() = nullptr;
    std::vector<KernelSignature> (*double_kernels)() = nullptr;
    std::vector<KernelConstant> (*constants)(const Variant& variant) = nullptr;  // constants of the kernels; null: none
    const char* source = nullptr;  // embedded source file of the kernels; null: variants/integrator/NAME.cuh
    KernelPart walks = {};     // kernel for subsurface walks, if the scene has some and tunable walks_apart is not 0
    KernelPart meshes = {};    // kernel for rays through meshes, if the traversal needs one of its own
    bool stores_hits = false;  // kernels pass hits on in device memory, where the paths of a queue lie, too

    std::vector<KernelSignature> kernels(std::size_t real_bytes) const {
        return real_bytes == sizeof(float) ? single_kernels() : double_kernels();
    }
};

struct Hooks {
    std::unique_ptr<Compaction> (*compaction)(const CellContext&) = nullptr;
    std::unique_ptr<Sorting> (*sorting)(const CellContext&) = nullptr;
    Layout layout = {};
    std::vector<KernelSignature> kernels = {};  // kernels of a compaction or sort, compiled from variants/AXIS/NAME.cuh
    IntegratorHook integrator = {};
    std::vector<std::string> options = {};  // compiler options that a choice of the axis `arithmetic` brings
    std::string real = "";                  // name of the type that a choice of the axis precision computes in
    bool bakes_scene = false;               // the specialisation makes the scene's numbers constants of the kernel
};

}  // namespace pt::cuda
