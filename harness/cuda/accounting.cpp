#include "harness/cuda/accounting.h"

#include <algorithm>
#include <numeric>

namespace pt::cuda {

namespace {

template <class T>
void download(const Job& job, T* host, const T* device, std::size_t count) {
    PT_CUDA_CHECK(cudaMemcpyAsync(host, device, count * sizeof(T), cudaMemcpyDeviceToHost, job.stream));
    PT_CUDA_CHECK(cudaStreamSynchronize(job.stream));
}

std::uint64_t sum_of(const std::vector<std::uint64_t>& counts) {
    return std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
}

Totals sum_of(const std::vector<Totals>& copies) {
    Totals sum;
    for (const Totals& copy : copies) {
        sum.paths.paths += copy.paths.paths;
        sum.paths.rays += copy.paths.rays;
        sum.paths.connections += copy.paths.connections;
        sum.paths.unfinished_walks += copy.paths.unfinished_walks;
        sum.cache_fills += copy.cache_fills;
        sum.cache_uses += copy.cache_uses;
    }
    return sum;
}

Totals download_totals(const Job& job) {
    std::vector<Totals> copies(counter_copies);
    download(job, copies.data(), job.totals, copies.size());
    return sum_of(copies);
}

std::vector<std::uint64_t> sum_of_copies(const std::vector<std::uint64_t>& counts, std::uint32_t copies) {
    std::vector<std::uint64_t> sums(counts.size() / copies);
    for (std::size_t i = 0; i < counts.size(); ++i) {
        sums[i / copies] += counts[i];
    }
    return sums;
}

std::vector<std::uint64_t> download_segments(const Job& job, const std::uint64_t* device_counts) {
    std::vector<std::uint64_t> counts(std::size_t{job.longest_path} * job.segments.copies);
    download(job, counts.data(), device_counts, counts.size());
    return counts;
}

// Turns counts of paths by length (in segments) into counts of paths that are alive at each segment.
std::vector<std::uint64_t> alive_by_segment(std::vector<std::uint64_t> by_length) {
    std::uint64_t alive = 0;
    for (std::size_t segment = by_length.size(); segment-- > 0;) {
        alive += by_length[segment];
        by_length[segment] = alive;
    }
    return by_length;
}

// Adds rays and sorted paths of an integrator that refills its queue, whose kernels count the rays themselves.
void add_refilled_work(const DeviceCounts& counts, WorkCounters& work) {
    const std::uint64_t segments = counts.totals.paths.rays;
    work.rays = segments + counts.totals.paths.connections;
    work.sorted = work.sorts > 0 ? segments : 0;
}

// Adds the work of kernels that trace one segment per thread: the counts of paths at each segment give that of rays.
void add_queue_work(const Job& job, const DeviceCounts& counts, WorkCounters& work) {
    const std::uint64_t segments = sum_of(counts.live);
    const std::uint64_t cache_uses = job.kept_rays > 0 ? counts.live.front() : 0;
    work.rays = segments - cache_uses + counts.totals.cache_fills + counts.totals.paths.connections;
    work.cache_hits = cache_uses - counts.totals.cache_fills;
    work.last_paths = counts.live.back();
    work.sorted = work.sorts > 0 ? segments - counts.live.back() : 0;
    work.compacted_away = work.compactions > 0 ? counts.in_play.front() - counts.in_play.back() : 0;
}

}  // namespace

void download_film(const Job& job, Film& film) {
    std::vector<std::int64_t> sums(std::size_t{3} * job.image_pixels);
    download(job, sums.data(), job.film.sums, sums.size());
    film.set(std::move(sums), download_faults(job));
}

FilmFaults download_faults(const Job& job) {
    FilmFaults faults;
    download(job, &faults, job.film.faults, 1);
    return faults;
}

DeviceCounts download_counts(const Job& job, const IntegratorTraits& integrator) {
    DeviceCounts counts;
    counts.totals = download_totals(job);
    download(job, &counts.health, job.health.counters, 1);
    counts.live = download_segments(job, job.segments.live);
    counts.in_play = download_segments(job, job.segments.in_play);
    if (integrator.has_queue && !integrator.refills_queue) {
        counts.live = sum_of_copies(counts.live, job.segments.copies);
        counts.in_play = sum_of_copies(counts.in_play, job.segments.copies);
    } else {
        // Integrators that have no queue or refill it count paths by length, in one copy of the counters, not several.
        counts.live.resize(job.longest_path);
        counts.live = alive_by_segment(std::move(counts.live));
    }
    return counts;
}

WorkCounters work_of(const Job& job, const IntegratorTraits& integrator, const WorkCounters& device_work,
                     const DeviceCounts& counts) {
    WorkCounters work = job.work;
    work += device_work;
    work.paths = counts.totals.paths.paths;
    work.connections = counts.totals.paths.connections;
    work.unfinished_walks = counts.totals.paths.unfinished_walks;
    work.cache_fills = counts.totals.cache_fills;
    if (integrator.refills_queue) {
        add_refilled_work(counts, work);
    } else if (integrator.has_queue) {
        add_queue_work(job, counts, work);
    } else {
        work.rays = counts.totals.paths.rays;
        work.cache_hits = counts.totals.cache_uses - counts.totals.cache_fills;
    }
    return work;
}

std::vector<std::uint64_t> reached_segments(const std::vector<std::uint64_t>& live) {
    return {live.begin(), std::find(live.begin(), live.end(), std::uint64_t{0})};
}

std::vector<CudaFacts::Kernel> kernel_facts(const Module& module, const std::vector<KernelSignature>& kernels) {
    std::vector<CudaFacts::Kernel> facts;
    for (const KernelSignature& kernel : kernels) {
        if (kernel.is_reported) {
            const KernelFacts fact = module.facts(kernel.name);
            facts.push_back({kernel.name, fact.registers, fact.local_bytes, fact.shared_bytes});
        }
    }
    return facts;
}

}  // namespace pt::cuda
