// What a command is at, on stderr, for whoever waits: nothing of a phase that is over within two seconds; then how long
// it has taken and, where that is known, what is left. On a terminal one line that is written over, in a log now and
// then a line: "render: reading the scene: 0:12 so far", "render: rendering: 0:12 elapsed, about 1:40 left".
#pragma once

#include <condition_variable>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

namespace pt {

// The lines alone; times are seconds of any clock.
class PhaseLines {
public:
    static constexpr double default_patience = 2;

    PhaseLines(std::string command, bool is_terminal, double patience = default_patience);
    // A phase begins, and whatever came before it has ended. `expected`: how long it is taken to last.
    void begin(const std::string& what, std::optional<double> expected, double now);
    // Tells that a share of the phase is done, from 0 to 1.
    void reached(double share, double now);
    void end() { is_over_ = true; }

    // The line about the phase that is due now; empty: none is.
    std::string due(double now);

private:
    std::string times(double elapsed) const;

    std::string command_, what_;
    bool is_terminal_, is_over_ = true;
    double patience_, begun_ = 0, next_ = 0;
    std::optional<double> expected_;
};

// Tells phases that last, by a thread of its own, which sleeps but for some microseconds every quarter of a second.
class PhaseWatch {
public:
    // PTBENCH_PATIENCE in the environment, in seconds, is for tests: with 0 each phase is told as it begins.
    explicit PhaseWatch(const std::string& command);
    ~PhaseWatch();
    PhaseWatch(const PhaseWatch&) = delete;
    PhaseWatch& operator=(const PhaseWatch&) = delete;

    void begin(const std::string& what, std::optional<double> expected = {});
    void reached(double share);
    // Ends the phase: nothing is told until the next one begins, and a line that stands on the terminal is gone.
    void end();

private:
    void tell();
    void clear();

    std::mutex mutex_;
    std::condition_variable has_ended_;
    bool is_ended_ = false, is_terminal_, stands_ = false;
    PhaseLines lines_;
    std::thread thread_;
};

}  // namespace pt
