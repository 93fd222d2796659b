// What a choice brings on the CUDA backend. Names no CUDA header, so that the registry and the tests of the CPU side
// compile without a toolkit.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "variants/cuda/path_store.h"

namespace pt {
class Variant;
}

namespace pt::cuda {

class Compaction;    // variants/cuda/stages.h
class Sorting;       // variants/cuda/stages.h
struct CellContext;  // variants/cuda/stages.h
struct Job;          // variants/cuda/job.h

struct Layout {
    // Of a store whose paths carry these fields; a layout may give them more.
    std::size_t (*bytes)(std::uint32_t capacity, std::size_t real_bytes, const PathFields& fields) = nullptr;
    FieldView (*segment)(const PathStore& store, std::size_t real_bytes) = nullptr;         // Path::segment
    FieldView (*origin_surface)(const PathStore& store, std::size_t real_bytes) = nullptr;  // Path::origin_surface
};

// What an integrator compiles and runs.
struct Integrator {
    void (*render)(Job&) = nullptr;   // enqueues the whole render on the job's stream
    void (*prepare)(Job&) = nullptr;  // before the clock starts: captures what can be replayed; may be null
    const char* source = nullptr;     // embedded; null: variants/integrator/NAME.cuh
    // "-DNAME=VALUE" beyond those of every integrator; may be null.
    std::vector<std::string> (*defines)(const Variant& variant) = nullptr;
    const char* kernels[4] = {};  // those that do the work, for what the compiler made of them
    bool stores_hits = false;     // they lie in device memory between kernels, as the paths of a queue do
};

struct Hooks {
    std::unique_ptr<Compaction> (*compaction)(const CellContext&) = nullptr;
    std::unique_ptr<Sorting> (*sorting)(const CellContext&) = nullptr;
    Layout layout = {};
    Integrator integrator = {};
    std::vector<std::string> options = {};  // arithmetic: for the compiler
    std::string real = "";                  // precision: the type's name
    bool bakes_scene = false;               // specialisation: the scene's numbers are constants of the kernel
};

}  // namespace pt::cuda
