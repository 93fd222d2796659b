// Names the work in progress when the process crashes. A crash in a variant (a segmentation fault, an abort) cannot be
// undone, but a line on stderr says which cell was running, and an open result file can get a last line. Exit code 3.
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

// Installs signal handlers, so that later crashes are reported with the work in progress. Handlers that others have
// set, as sanitizers do, stay. To be called once, by the thread that does all the work.
void name_crashes();

// While an `AtWork` lives, a crash report names `what`, after the work named by outer ones: "CELL, sample 2 (seed 3)".
// Works only on the thread that called name_crashes(). Copies the text: not to be made inside a timed region.
class AtWork {
public:
    explicit AtWork(const std::string& what);
    ~AtWork();
    AtWork(const AtWork&) = delete;
    AtWork& operator=(const AtWork&) = delete;

private:
    bool is_told_ = false;
};

// While a `LastLine` lives, a crash appends `line(signal's name)` to the open file `descriptor` and ends the crash
// report with `afterwards`. The constructor makes one line for each signal, since a signal handler cannot allocate. At
// most one `LastLine` may live in a process.
class LastLine {
public:
    LastLine(int descriptor, const std::function<std::string(const std::string& signal)>& line,
             const std::string& afterwards);
    ~LastLine();
    LastLine(const LastLine&) = delete;
    LastLine& operator=(const LastLine&) = delete;
};

}  // namespace pt
