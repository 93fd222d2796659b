// The CPU time of this process, from which a render's cpu_ms is computed.
#pragma once

#include <ctime>

namespace pt {

// CPU time of all threads of this process since its start, in milliseconds.
inline double process_cpu_ms() {
    timespec time{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return 1e3 * static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_nsec);
}

}  // namespace pt
