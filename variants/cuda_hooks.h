// What a choice brings on the CUDA backend. Names no CUDA header, so that the registry and the tests of the CPU side
// compile without a toolkit.
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

class Compaction;        // variants/cuda/stages.h
class Integrator;        // variants/cuda/integrator.h
class Sorting;           // variants/cuda/stages.h
struct CellContext;      // variants/cuda/stages.h
struct IntegratorNeeds;  // variants/cuda/integrator.h
template <class Real>
struct JobOf;  // variants/cuda/job.h

struct Layout {
    // Bytes of a store of `capacity` paths that carry these fields; a layout may give them more.
    std::size_t (*bytes)(std::uint32_t capacity, std::size_t real_bytes, const PathFields& fields) = nullptr;
    FieldView (*segment)(const PathStore& store, std::size_t real_bytes) = nullptr;         // Path::segment
    FieldView (*origin_surface)(const PathStore& store, std::size_t real_bytes) = nullptr;  // Path::origin_surface
};

// What a layout on the device says of itself, for both sizes of a Real, which the host knows at run time only.
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

// A number that the kernels of an integrator are compiled with: tuned::NAME in their program.
struct KernelConstant {
    std::string name;
    std::uint32_t value = 0;
};

// A source with one kernel, which only some of an integrator's programs have.
struct KernelPart {
    const char* source = nullptr;  // embedded; null: the integrator has none such
    KernelSignature single_kernel = {};
    KernelSignature double_kernel = {};
};

// What an integrator compiles, and how it is made for a cell.
struct IntegratorHook {
    std::unique_ptr<Integrator> (*make_single)(JobOf<float>& job, IntegratorNeeds&& needs) = nullptr;
    std::unique_ptr<Integrator> (*make_double)(JobOf<double>& job, IntegratorNeeds&& needs) = nullptr;
    std::vector<KernelSignature> (*single_kernels)() = nullptr;
    std::vector<KernelSignature> (*double_kernels)() = nullptr;
    std::vector<KernelConstant> (*constants)(const Variant& variant) = nullptr;  // may be null
    const char* source = nullptr;  // embedded; null: variants/integrator/NAME.cuh
    KernelPart walks = {};         // takes subsurface walks, where the scene has some and walks_apart is not 0
    KernelPart meshes = {};        // takes rays through meshes, where the traversal needs a kernel of its own
    bool stores_hits = false;      // they lie in device memory between kernels, as the paths of a queue do

    std::vector<KernelSignature> kernels(std::size_t real_bytes) const {
        return real_bytes == sizeof(float) ? single_kernels() : double_kernels();
    }
};

struct Hooks {
    std::unique_ptr<Compaction> (*compaction)(const CellContext&) = nullptr;
    std::unique_ptr<Sorting> (*sorting)(const CellContext&) = nullptr;
    Layout layout = {};
    std::vector<KernelSignature> kernels = {};  // of a compaction or sorting that NVRTC compiles: of AXIS/NAME.cuh
    IntegratorHook integrator = {};
    std::vector<std::string> options = {};  // arithmetic: for the compiler
    std::string real = "";                  // precision: the type's name
    bool bakes_scene = false;               // specialisation: the scene's numbers are constants of the kernel
};

}  // namespace pt::cuda
