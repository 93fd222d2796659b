#include "harness/cli/start_anew.h"

#include <cstdlib>
#include <regex>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include "harness/bench/benchmark_flags.h"
#include "harness/failure.h"
#include "harness/ranks/launch.h"
#include "harness/say.h"

namespace pt {

namespace {

// Spin count of waiting threads in commands that time renders: 0.1 to 0.4 ms, at 40 to 140 cycles a turn. Measured
// (results/*/waiting.txt): on an idle machine as fast as the default of 300,000; with 1,000 a wavefront of 32x32 takes
// two to three times as long.
constexpr const char* spins_where_times_count = "10000";
// Spin count in other commands: beside other jobs, a small wavefront takes less than a third of the time without
// spinning (results/*/waiting.txt).
constexpr const char* spins_elsewhere = "0";

bool is_set(const char* name) { return std::getenv(name) != nullptr; }

// Sets the spin count that suits the command, unless the user has set one; returns whether the environment changed.
bool shorten_waits(const std::string& command) {
    if (is_set("OMP_WAIT_POLICY") || is_set("GOMP_SPINCOUNT")) {
        return false;
    }
    const bool times_count = command == "run" || command == "autotune";
    return ::setenv("GOMP_SPINCOUNT", times_count ? spins_where_times_count : spins_elsewhere, 0) == 0;
}

bool ignore_benchmark_variables(const std::string& command) {
    std::vector<std::string> names = benchmark_variables();
    std::erase_if(names, [](const std::string& name) { return !is_set(name.c_str()); });
    for (const std::string& name : names) {
        ::unsetenv(name.c_str());
    }
    const bool speaks = launch_from([](const char* name) { return std::getenv(name); }).rank == 0;
    if (!names.empty() && command == "run" && speaks) {
        say("ptbench: ignored in the environment: {} (options are given on the command line)\n",
            fmt::join(names, ", "));
    }
    return !names.empty();
}

// Refuses invalid values of OMP_NUM_THREADS, which libgomp would silently replace by its default.
void check_threads() {
    constexpr const char* name = "OMP_NUM_THREADS";
    const char* const value = std::getenv(name);
    static const std::regex numbers(R"(\s*\+?0*[1-9][0-9]{0,8}\s*(,\s*\+?0*[1-9][0-9]{0,8}\s*)*)");
    if (value != nullptr && !std::regex_match(value, numbers)) {
        throw InputError("the environment", name, fmt::format("\"{}\"", value),
                         "a number of threads from 1, or none: unset it for one a processor");
    }
}

}  // namespace

void start_anew(char** argv) {
    const std::string command = argv[0] != nullptr && argv[1] != nullptr ? argv[1] : "";
    check_threads();
    const bool waits = shorten_waits(command);
    const bool flags = ignore_benchmark_variables(command);
    if (waits || flags) {
        ::execv("/proc/self/exe", argv);
    }
}

}  // namespace pt
