#include "harness/machine/chip_rates.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstring>
#include <memory>

#include <omp.h>

namespace pt {

namespace {

constexpr double least_seconds = 0.02;  // least duration of a measurement, which repeats its work
constexpr int measurements = 3;         // measurements of each rate, of which the fastest counts
constexpr std::uint64_t smallest_copy = std::uint64_t{1} << 14, largest_copy = std::uint64_t{1} << 28;

double seconds_now() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// Units of work per second: `work` does `units` of them in a call.
template <class Work>
double best_rate(double units, const Work& work) {
    double best = 0;
    work();  // an untimed call warms up
    for (int i = 0; i < measurements; ++i) {
        const double start = seconds_now();
        double done = 0, seconds = 0;
        while (seconds < least_seconds) {
            work();
            done += units;
            seconds = seconds_now() - start;
        }
        best = std::max(best, done / seconds);
    }
    return best;
}

// Measures a copy's rate: each thread copies its part many times, so that starting threads hardly counts.
CopyRate copy_rate(std::uint64_t bytes, unsigned char* to, const unsigned char* from) {
    const auto threads = static_cast<std::uint64_t>(omp_get_max_threads());
    const std::uint64_t part = std::max<std::uint64_t>(64, bytes / threads / 64 * 64);
    const std::uint64_t rounds = std::max<std::uint64_t>(1, (std::uint64_t{1} << 24) / part);
    const double rate = best_rate(2.0 * static_cast<double>(threads * part * rounds), [&] {
#pragma omp parallel
        {
            const auto thread = static_cast<std::uint64_t>(omp_get_thread_num());
            for (std::uint64_t round = 0; round < rounds; ++round) {
                std::memcpy(to + thread * part, from + thread * part, part);
                std::atomic_signal_fence(std::memory_order_seq_cst);  // keeps the compiler from leaving out copies
            }
        }
    });
    return {bytes, 1e-9 * rate};
}

std::vector<CopyRate> copy_rates() {
    const std::uint64_t room = largest_copy + 64 * static_cast<std::uint64_t>(omp_get_max_threads());
    const auto from = std::make_unique_for_overwrite<unsigned char[]>(room);
    const auto to = std::make_unique_for_overwrite<unsigned char[]>(room);
    std::memset(from.get(), 1, room);
    std::memset(to.get(), 2, room);
    std::vector<CopyRate> rates;
    for (std::uint64_t bytes = smallest_copy; bytes <= largest_copy; bytes *= 4) {
        rates.push_back(copy_rate(bytes, to.get(), from.get()));
    }
    return rates;
}

using Lanes = float __attribute__((vector_size(32)));

// Ten independent chains of multiplications and additions hide the latency of both.
double gflops() {
    constexpr int steps = 1 << 16, chains = 10, lanes = sizeof(Lanes) / sizeof(float);
    const int threads = omp_get_max_threads();
    const double rate = best_rate(2.0 * steps * chains * lanes * threads, [&] {
#pragma omp parallel
        {
            const Lanes factor = Lanes{} + 0.999f, term = Lanes{} + 0.001f;
            Lanes a = term, b = a, c = a, d = a, e = a, f = a, g = a, h = a, i = a, j = a;
            for (int step = 0; step < steps; ++step) {
                a = a * factor + term, b = b * factor + term, c = c * factor + term, d = d * factor + term;
                e = e * factor + term, f = f * factor + term, g = g * factor + term, h = h * factor + term;
                i = i * factor + term, j = j * factor + term;
            }
            const Lanes sum = a + b + c + d + e + f + g + h + i + j;
            volatile float kept = sum[0];  // keeps the compiler from removing the sums
            (void)kept;
        }
    });
    return 1e-9 * rate;
}

double atomics_per_s() {
    constexpr int additions = 1 << 12;
    std::atomic<std::uint64_t> counter{0};
    return best_rate(static_cast<double>(additions) * omp_get_max_threads(), [&] {
#pragma omp parallel
        for (int i = 0; i < additions; ++i) {
            counter.fetch_add(1, std::memory_order_relaxed);
        }
    });
}

double fork_join_us() {
    std::vector<double> seconds(501);
    for (double& one : seconds) {
        const double start = seconds_now();
#pragma omp parallel
        { std::atomic_signal_fence(std::memory_order_seq_cst); }
        one = seconds_now() - start;
    }
    const auto middle = seconds.begin() + static_cast<std::ptrdiff_t>(seconds.size() / 2);
    std::nth_element(seconds.begin(), middle, seconds.end());
    return 1e6 * *middle;
}

}  // namespace

ChipRates measure_chip_rates() {
    return {.threads = static_cast<std::uint64_t>(omp_get_max_threads()),
            .copies = copy_rates(),
            .gflops = gflops(),
            .atomics_per_s = atomics_per_s(),
            .fork_join_us = fork_join_us()};
}

}  // namespace pt
