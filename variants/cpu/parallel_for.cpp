#include "variants/cpu/parallel_for.h"

#include <algorithm>
#include <exception>
#include <mutex>
#include <numeric>

#include <omp.h>
#include <thrust/for_each.h>
#include <thrust/iterator/counting_iterator.h>
#include <thrust/system/omp/execution_policy.h>

namespace pt {

namespace detail {

namespace {
// A step coprime to `chunks` near the golden ratio: consecutive multiples of it modulo `chunks` are spread evenly.
std::size_t spreading_step(std::size_t chunks) {
    std::size_t step = std::max<std::size_t>(1, static_cast<std::size_t>(0.6180339887 * static_cast<double>(chunks)));
    while (std::gcd(step, chunks) != 1) {
        ++step;
    }
    return step;
}
}  // namespace

void run_chunks(std::size_t count, std::size_t chunk, void (*run)(void*, std::size_t, std::size_t), void* context) {
    if (count == 0) {
        return;
    }
    const std::size_t chunks = (count + chunk - 1) / chunk;
    const std::size_t step = spreading_step(chunks);
    std::exception_ptr failure;
    std::mutex failure_mutex;
    const auto first = thrust::counting_iterator<std::size_t>(0);
    thrust::for_each(thrust::omp::par, first, first + static_cast<std::ptrdiff_t>(chunks), [&](std::size_t turn) {
        const std::size_t begin = turn * step % chunks * chunk;
        try {
            run(context, begin, std::min(begin + chunk, count));
        } catch (...) {  // no exception may leave an OpenMP region
            const std::lock_guard lock(failure_mutex);
            failure = std::current_exception();
        }
    });
    if (failure) {
        std::rethrow_exception(failure);
    }
}

}  // namespace detail

void wake_threads() {
    const auto threads = static_cast<std::size_t>(parallel_threads());
    parallel_for(threads, 1, [](std::size_t, std::size_t) {});
}

int parallel_threads() { return omp_get_max_threads(); }

}  // namespace pt
