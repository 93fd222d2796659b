#include "harness/cli/short_waits.h"

#include <cstdlib>
#include <cstring>

#include <unistd.h>

namespace pt {

namespace {

// Turns of a loop with a pause, which takes 40 to 140 cycles: 0.1 to 0.4 ms. Measured (results/*/waiting.txt): on an
// idle machine as fast as the default of 300,000; with 1,000 a wavefront of 32x32 takes two to three times as long.
constexpr const char* spins_where_times_count = "10000";
// Beside other jobs a small wavefront takes less than a third of that time without a single turn (the same file).
constexpr const char* spins_elsewhere = "0";

bool times_count(const char* command) {
    return command != nullptr && (std::strcmp(command, "run") == 0 || std::strcmp(command, "autotune") == 0);
}

}  // namespace

void shorten_waits(char** argv) {
    for (const char* setting : {"OMP_WAIT_POLICY", "GOMP_SPINCOUNT"}) {
        if (std::getenv(setting) != nullptr) {
            return;
        }
    }
    if (::setenv("GOMP_SPINCOUNT", times_count(argv[1]) ? spins_where_times_count : spins_elsewhere, 0) == 0) {
        ::execv("/proc/self/exe", argv);
    }
}

}  // namespace pt
