#include "harness/bench/machine.h"

#include <algorithm>
#include <cctype>
#include <chrono>
#include <fstream>

#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <sys/utsname.h>
#include <thrust/version.h>

#include "build_info.h"  // generated at every build
#include "variants/cpu/parallel_for.h"

namespace pt {

namespace {

std::string value_in(const std::string& file, const std::string& key, char separator) {
    std::ifstream stream(file);
    for (std::string line; std::getline(stream, line);) {
        if (line.starts_with(key)) {
            const std::size_t start = line.find_first_not_of(" \t\"", line.find(separator) + 1);
            const std::size_t end = line.find_last_not_of(" \t\"");
            return start == std::string::npos ? "" : line.substr(start, end - start + 1);
        }
    }
    return "";
}

std::string cpu_model() {
    const std::string model = value_in("/proc/cpuinfo", "model name", ':');
    return model.empty() ? "unknown CPU" : model;
}

std::string operating_system() {
    utsname kernel{};
    uname(&kernel);
    return fmt::format("{}, Linux {}", value_in("/etc/os-release", "PRETTY_NAME", '='), kernel.release);
}

}  // namespace

std::string machine_name() {
    std::string name;
    for (const char c : cpu_model()) {
        const auto byte = static_cast<unsigned char>(c);
        if (std::isalnum(byte) != 0) {
            name += static_cast<char>(std::tolower(byte));
        } else if (!name.empty() && name.back() != '-') {
            name += '-';
        }
    }
    while (!name.empty() && name.back() == '-') {
        name.pop_back();
    }
    return fmt::format("{}-{}-threads", name, parallel_threads());
}

std::string git_sha() { return PTBENCH_GIT_SHA; }

bool git_dirty() { return PTBENCH_GIT_DIRTY != 0; }

std::vector<std::pair<std::string, std::string>> machine_context() {
    return {
        {"ptbench.schema_version", "1"},
        {"ptbench.version", PTBENCH_VERSION},
        {"ptbench.git_sha", git_sha()},
        {"ptbench.git_dirty", git_dirty() ? "true" : "false"},
        {"ptbench.machine", machine_name()},
        {"ptbench.cpu_model", cpu_model()},
        {"ptbench.os", operating_system()},
        {"ptbench.compiler", PTBENCH_COMPILER},
        {"ptbench.compiler_flags", PTBENCH_COMPILER_FLAGS},
        {"ptbench.build_type", PTBENCH_BUILD_TYPE},
        {"ptbench.threads", std::to_string(parallel_threads())},
        {"ptbench.thrust_version",
         fmt::format("{}.{}.{}", THRUST_MAJOR_VERSION, THRUST_MINOR_VERSION, THRUST_SUBMINOR_VERSION)},
        {"ptbench.thrust_system", "omp"},
        {"ptbench.google_benchmark_version", PTBENCH_BENCHMARK_VERSION},
    };
}

double measure_clock_mhz() {
    constexpr std::uint64_t additions = 400000;
    double best = 0;
    for (int attempt = 0; attempt < 3; ++attempt) {
        std::uint64_t sum = 0;
        const auto start = std::chrono::steady_clock::now();
        for (std::uint64_t i = 0; i < additions / 8; ++i) {
            // Opaque to the optimiser, and each addition waits for the one before it.
            asm volatile(
                "add $1, %0\n\tadd $1, %0\n\tadd $1, %0\n\tadd $1, %0\n\tadd $1, %0\n\tadd $1, %0\n\tadd $1, %0\n\tadd "
                "$1, %0"
                : "+r"(sum));
        }
        const double microseconds =
            std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count();
        best = std::max(best, static_cast<double>(additions) / microseconds);
    }
    return best;
}

}  // namespace pt
