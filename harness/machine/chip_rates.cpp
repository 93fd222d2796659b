#include "harness/machine/chip_rates.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <memory>

#include <omp.h>

namespace pt {

namespace {

constexpr double least_seconds = 0.02;  // time for which each thread repeats its work, at least
constexpr int measurements = 3;         // the best counts, since other processes disturb some
constexpr std::uint64_t smallest_block = std::uint64_t{1} << 14, largest_block = std::uint64_t{1} << 26;
constexpr std::uint64_t most_memory = std::uint64_t{1} << 28;  // of all blocks that are read, and as much again

double seconds_now() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// Units of work per second of all threads. `make_work` makes a thread's work in that thread, so that its memory is the
// thread's own; a call of the work does `units`. Threads begin together and are timed one by one: how long they take
// to start does not count.
template <class MakeWork>
double best_rate(double units, const MakeWork& make_work) {
    double best = 0;
    for (int i = 0; i < measurements; ++i) {
        double rate = 0;
#pragma omp parallel reduction(+ : rate)
        {
            auto work = make_work();
            work();  // warms up
#pragma omp barrier
            const double start = seconds_now();
            double done = 0, seconds = 0;
            while (seconds < least_seconds) {
                work();
                done += units;
                seconds = seconds_now() - start;
            }
            rate = done / seconds;
        }
        best = std::max(best, rate);
    }
    return best;
}

struct Free {
    void operator()(void* memory) const { std::free(memory); }
};
using Block = std::unique_ptr<void, Free>;

Block block_of(std::uint64_t bytes, int value) {
    Block block(std::aligned_alloc(4096, bytes));
    std::memset(block.get(), value, bytes);  // touched first by the thread that uses it
    return block;
}

CopyRate copy_rate(std::uint64_t bytes) {
    const std::uint64_t rounds = std::max<std::uint64_t>(1, (std::uint64_t{1} << 20) / bytes);
    const double rate = best_rate(2.0 * static_cast<double>(bytes * rounds), [&] {
        return [from = block_of(bytes, 1), to = block_of(bytes, 2), bytes, rounds] {
            for (std::uint64_t round = 0; round < rounds; ++round) {
                std::memcpy(to.get(), from.get(), bytes);
                std::atomic_signal_fence(std::memory_order_seq_cst);  // no round may be left out
            }
        };
    });
    return {bytes, 1e-9 * rate};
}

std::vector<CopyRate> copy_rates() {
    const std::uint64_t most = most_memory / static_cast<std::uint64_t>(omp_get_max_threads());
    std::vector<CopyRate> rates;
    for (std::uint64_t bytes = smallest_block; bytes <= std::min(most, largest_block); bytes *= 4) {
        rates.push_back(copy_rate(bytes));
    }
    return rates;
}

#if defined(__AVX512F__)
constexpr int vector_bytes = 64;
#else
constexpr int vector_bytes = 32;
#endif
using Lanes = float __attribute__((vector_size(vector_bytes)));

// Independent chains of a multiplication and an addition, each from a start of its own, so that none can be left out.
double gflops() {
    constexpr int steps = 1 << 14, chains = 12, lanes = sizeof(Lanes) / sizeof(float);
    const double rate = best_rate(2.0 * steps * chains * lanes, [] {
        return [start = static_cast<float>(omp_get_thread_num())]() mutable {
            const Lanes factor = Lanes{} + 0.999f, term = Lanes{} + 0.001f;
            Lanes a = term + start, b = a + 1.0f, c = a + 2.0f, d = a + 3.0f, e = a + 4.0f, f = a + 5.0f;
            Lanes g = a + 6.0f, h = a + 7.0f, i = a + 8.0f, j = a + 9.0f, k = a + 10.0f, l = a + 11.0f;
            for (int step = 0; step < steps; ++step) {
                a = a * factor + term, b = b * factor + term, c = c * factor + term, d = d * factor + term;
                e = e * factor + term, f = f * factor + term, g = g * factor + term, h = h * factor + term;
                i = i * factor + term, j = j * factor + term, k = k * factor + term, l = l * factor + term;
            }
            const Lanes sum = a + b + c + d + e + f + g + h + i + j + k + l;
            float total = 0;
            for (int lane = 0; lane < lanes; ++lane) {
                total += sum[lane];
            }
            volatile float kept = total;  // every lane of every chain has a use
            start = kept * 1e-6f;
        };
    });
    return 1e-9 * rate;
}

double atomics_per_s() {
    constexpr int additions = 1 << 12;
    std::atomic<std::uint64_t> counter{0};
    return best_rate(additions, [&] {
        return [&counter] {
            for (int i = 0; i < additions; ++i) {
                counter.fetch_add(1, std::memory_order_relaxed);
            }
        };
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
