// What a render on the device left behind: the film, and what its kernels counted, in the words of a result.
#pragma once

#include "harness/render/renderer.h"
#include "variants/cuda/job.h"

namespace pt::cuda {

// These functions wait for the device.
void download_film(const Job& job, Film& film);
FilmFaults download_faults(const Job& job);

struct DeviceCounts {
    Totals totals;
    HealthCounters health;
    std::vector<std::uint64_t> live;     // by segment: paths that were alive when it was traced
    std::vector<std::uint64_t> in_play;  // by segment: paths that were looked at; of integrators with a queue
};
DeviceCounts download_counts(const Job& job, const IntegratorTraits& integrator);

// The work of a job: what it counted on the host, the integrator's loops on the device (device_work) and its kernels.
WorkCounters work_of(const Job& job, const IntegratorTraits& integrator, const WorkCounters& device_work,
                     const DeviceCounts& counts);

// The counts of `live` up to the last segment that a path reached.
std::vector<std::uint64_t> reached_segments(const std::vector<std::uint64_t>& live);

// The registers and memory that the compiler gave the integrator's kernels.
std::vector<CudaFacts::Kernel> kernel_facts(const Module& module, const std::vector<KernelSignature>& kernels);

}  // namespace pt::cuda
