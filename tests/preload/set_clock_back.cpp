// Sets the clock that tells the date back by an hour at every reading, as a correction of the system's clock may: for
// LD_PRELOAD. Clocks that are never set are as they were.
#include <atomic>

#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

extern "C" int clock_gettime(clockid_t clock, timespec* now) noexcept {
    static std::atomic<long> readings = 0;
    const long result = ::syscall(SYS_clock_gettime, clock, now);
    if (clock == CLOCK_REALTIME && result == 0) {
        now->tv_sec -= 3600 * readings++;
    }
    return static_cast<int>(result);
}
