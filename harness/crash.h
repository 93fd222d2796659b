// Names a crash. What a variant does to the process it runs in (a segmentation fault, an abort) cannot be undone, but
// the line that is left says what was at work, and a file that goes on can be left a last line. Exit code 3.
#pragma once

#include <array>
#include <csignal>
#include <functional>
#include <string>

namespace pt {

struct CrashSignal {
    int number = 0;
    const char* name = "";
};
inline constexpr std::array<CrashSignal, 5> crash_signals{{{SIGSEGV, "segmentation fault (SIGSEGV)"},
                                                           {SIGBUS, "bus error (SIGBUS)"},
                                                           {SIGFPE, "arithmetic fault (SIGFPE)"},
                                                           {SIGILL, "illegal instruction (SIGILL)"},
                                                           {SIGABRT, "abort (SIGABRT)"}}};

// Installs handlers, so that a crash from now on is named. A handler that somebody else has set, as sanitizers do,
// stays. To be called once, by the thread that everything is at work on.
void name_crashes();

// While it lives, a crash names `what`, after what was at work already: "CELL, sample 2 (seed 3)". Only on the thread
// that called name_crashes(); elsewhere it does nothing. Costs a copy: not to be made while a time is taken.
class AtWork {
public:
    explicit AtWork(const std::string& what);
    ~AtWork();
    AtWork(const AtWork&) = delete;
    AtWork& operator=(const AtWork&) = delete;

private:
    bool is_told_ = false;
};

// While it lives, a crash appends `line(signal's name)` to the open file `descriptor` and ends what it says with
// `afterwards`. The lines are made now, one a signal: a handler can make none. One at a time in a process.
class LastLine {
public:
    LastLine(int descriptor, const std::function<std::string(const std::string& signal)>& line,
             const std::string& afterwards);
    ~LastLine();
    LastLine(const LastLine&) = delete;
    LastLine& operator=(const LastLine&) = delete;
};

}  // namespace pt
