#include "harness/machine/cpu_clock.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <fstream>

#include <fmt/format.h>
#include <unistd.h>

#if defined(__x86_64__)
#include <x86intrin.h>
#endif

namespace pt {

namespace {

constexpr double multiplication_latency = 3;
// Relative difference allowed between the rates of two instruction chains: the clock may change from pass to pass,
// while a chain folded by the processor is wrong by a factor of 2 or more.
constexpr double chain_tolerance = 0.1;
// Bounds on the ratio of the core clock to the time stamp counter's rate: turbo reaches 4.3 (1.1 GHz processors that
// boost to 4.7 GHz), and idle cores run at a tenth.
constexpr double most_over_time_stamps = 5;
constexpr double least_over_time_stamps = 0.05;
// acpi-cpufreq reports the clock without boost, which can be up to twice as high.
constexpr double most_over_cpufreq = 2.5;

constexpr std::uint64_t steps_per_pass = 100000;
constexpr std::uint64_t steps_per_turn = 8;  // steps of a chain in one turn: the count of .rept in its assembler code

// Calls `turn` until an instruction chain has made `steps` steps, steps_per_turn in each call. Every step depends on
// the one before, by a register that carries over from call to call.
template <class Turn>
[[maybe_unused]] void chain(std::uint64_t steps, const Turn& turn) {
    for (std::uint64_t i = 0; i < steps / steps_per_turn; ++i) {
        turn();
    }
}

// The instructions of a chain are inline assembly, since the optimiser would fold them.
#if defined(__x86_64__)

void additions(std::uint64_t steps) {
    std::uint64_t sum = 0;
    const std::uint64_t one = 1;
    chain(steps, [&] { asm volatile(".rept 8\n\tadd %1, %0\n\t.endr" : "+r"(sum) : "r"(one)); });
}

void multiplications(std::uint64_t steps) {
    std::uint32_t product = 1;
    const std::uint32_t factor = 3;
    chain(steps, [&] { asm volatile(".rept 8\n\timul %1, %0\n\t.endr" : "+r"(product) : "r"(factor)); });
}

double time_stamp() { return static_cast<double>(__rdtsc()); }

#elif defined(__aarch64__)

void additions(std::uint64_t steps) {
    std::uint64_t sum = 0;
    const std::uint64_t one = 1;
    chain(steps, [&] { asm volatile(".rept 8\n\tadd %0, %0, %1\n\t.endr" : "+r"(sum) : "r"(one)); });
}

// Arm has neither the chain of multiplications, whose latency differs between Arm's cores, nor time stamps, since the
// counter's rate is unrelated to the clock.
void multiplications(std::uint64_t) {}
double time_stamp() { return 0; }

#else

void additions(std::uint64_t) {}
void multiplications(std::uint64_t) {}
double time_stamp() { return 0; }

#endif

struct Pass {
    double microseconds = 0;
    double time_stamps = 0;
};

template <class Chain>
Pass timed(const Chain& chain) {
    const auto start = std::chrono::steady_clock::now();
    const double first = time_stamp();
    chain(steps_per_pass);
    const double last = time_stamp();
    return {std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count(), last - first};
}

double cpufreq_max_mhz() {
    std::ifstream stream("/sys/devices/system/cpu/cpu0/cpufreq/cpuinfo_max_freq");
    double kilohertz = 0;
    return stream >> kilohertz ? 1e-3 * kilohertz : 0;
}

}  // namespace

std::string clock_problem(const ClockEvidence& e) {
    if (!(e.additions_per_us > 0)) {
        return "no chain of instructions of known latency for this kind of processor";
    }
    if (e.multiplications_per_us > 0) {
        const double latency = e.additions_per_us / e.multiplications_per_us;
        if (std::abs(latency / multiplication_latency - 1) > chain_tolerance) {
            return fmt::format("additions say {:.0f} MHz, multiplications {:.0f} MHz", e.additions_per_us,
                               multiplication_latency * e.multiplications_per_us);
        }
    }
    if (e.time_stamps_per_us > 0 && (e.additions_per_us > most_over_time_stamps * e.time_stamps_per_us ||
                                     e.additions_per_us < least_over_time_stamps * e.time_stamps_per_us)) {
        return fmt::format("additions say {:.0f} MHz, the time stamp counter runs at {:.0f} MHz", e.additions_per_us,
                           e.time_stamps_per_us);
    }
    if (e.cpufreq_max_mhz > 0 && e.additions_per_us > most_over_cpufreq * e.cpufreq_max_mhz) {
        return fmt::format("additions say {:.0f} MHz, the kernel's highest clock is {:.0f} MHz", e.additions_per_us,
                           e.cpufreq_max_mhz);
    }
    return "";
}

std::optional<double> clock_of(const ClockEvidence& evidence) {
    return clock_problem(evidence).empty() ? std::optional(evidence.additions_per_us) : std::nullopt;
}

namespace {

ClockEvidence measure_once() {
    static const double highest = cpufreq_max_mhz();
    ClockEvidence evidence{.cpufreq_max_mhz = highest};
    for (int attempt = 0; attempt < 4; ++attempt) {
        const Pass added = timed(additions);
        const Pass multiplied = timed(multiplications);
        // An interrupted pass of a chain has too low a rate, and a pass too short to be timed is no evidence.
        const auto rate = [](double steps, const Pass& pass) {
            return pass.microseconds > 1 ? steps / pass.microseconds : 0;
        };
        evidence.additions_per_us = std::max(evidence.additions_per_us, rate(steps_per_pass, added));
        evidence.multiplications_per_us = std::max(evidence.multiplications_per_us, rate(steps_per_pass, multiplied));
        evidence.time_stamps_per_us = std::max(evidence.time_stamps_per_us, rate(added.time_stamps, added));
    }
    return evidence;
}

}  // namespace

// On a busy machine every pass of a chain may be interrupted, so a contradiction is measured again; the contradiction
// of a folded chain persists.
ClockEvidence measure_clock_evidence() {
    constexpr int most_tries = 5;
    ClockEvidence evidence = measure_once();
    for (int tries = 1; tries < most_tries && !clock_problem(evidence).empty(); ++tries) {
        evidence = measure_once();
    }
    return evidence;
}

std::string clock_method() {
#if defined(__x86_64__)
    return "a chain of register additions, held against one of multiplications, the time stamp counter and cpufreq";
#elif defined(__aarch64__)
    return "a chain of register additions, held against cpufreq";
#else
    return "unknown: no chain of instructions of known latency for this kind of processor";
#endif
}

}  // namespace pt
