// Shows on stderr which phase a command is in: nothing for the first two seconds, then the elapsed time and, where it
// can be told, the remaining time. A terminal gets one line that is overwritten, a log gets a line from time to time:
// "render: reading the scene: 0:12 so far", "render: rendering: 0:12 elapsed, about 1:40 left".
#pragma once

#include <condition_variable>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

namespace pt {

// Composes the lines about a command's phases, without printing them. Times are in seconds of any clock.
class PhaseLines {
public:
    static constexpr double default_patience = 2;

    PhaseLines(std::string command, bool is_terminal, double patience = default_patience);
    // Begins a phase and ends the previous one. `expected` is the expected duration in seconds.
    void begin(const std::string& what, std::optional<double> expected, double now);
    // Records which share of the phase is done, from 0 to 1.
    void reached(double share, double now);
    void end() { is_over_ = true; }

    // The progress line to show at the time `now`; empty if it is too early for the next one.
    std::string due(double now);

private:
    std::string times(double elapsed) const;

    std::string command_, what_;
    bool is_terminal_, is_over_ = true;
    double patience_, begun_ = 0, next_ = 0;
    std::optional<double> expected_;
};

// Shows long phases of a command on stderr from a thread of its own, which wakes up every quarter of a second.
class PhaseWatch {
public:
    // Starts the thread that shows phases. For tests, the environment variable PTBENCH_PATIENCE sets the seconds before
    // a phase is shown; with 0 each phase is shown as it begins.
    explicit PhaseWatch(const std::string& command);
    ~PhaseWatch();
    PhaseWatch(const PhaseWatch&) = delete;
    PhaseWatch& operator=(const PhaseWatch&) = delete;

    void begin(const std::string& what, std::optional<double> expected = {});
    void reached(double share);
    // Ends the phase: nothing is shown until the next one begins, and the terminal's line is erased.
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
