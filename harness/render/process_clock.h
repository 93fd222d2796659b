// How long all threads of this process have computed: what a render's cpu_ms is a difference of.
#pragma once

#include <ctime>

namespace pt {

// CPU time of this process in milliseconds, since it began.
inline double process_cpu_ms() {
    timespec time{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return 1e3 * static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_nsec);
}

}  // namespace pt
