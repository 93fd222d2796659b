// Reads back from the device what a render produced: the film, and the counters of its kernels in the form of a result.
#pragma once

#include "harness/render/renderer.h"
#include "variants/cuda/job.h"

namespace pt::cuda {

// Download functions: each waits until the device has finished the render `job`.
void download_film(const Job& job, Film& film);
FilmFaults download_faults(const Job& job);

struct DeviceCounts {
    Totals totals;
    HealthCounters health;
    std::vector<std::uint64_t> live;     // [k]: number of paths whose segment k + 1 was traced
    std::vector<std::uint64_t> in_play;  // [k]: number of paths queued at segment k + 1, ended or not
};
DeviceCounts download_counts(const Job& job, const IntegratorTraits& integrator);

// A render's work counters: the host's, those of the integrator's device loops (device_work) and of its kernels.
WorkCounters work_of(const Job& job, const IntegratorTraits& integrator, const WorkCounters& device_work,
                     const DeviceCounts& counts);

// The counts of live paths up to the last segment that a path reached.
std::vector<std::uint64_t> reached_segments(const std::vector<std::uint64_t>& live);

// The registers and memory that the compiler gave to the integrator's kernels.
std::vector<CudaFacts::Kernel> kernel_facts(const Module& module, const std::vector<KernelSignature>& kernels);

}  // namespace pt::cuda
