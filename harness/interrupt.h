// Handles SIGINT (Ctrl-C), SIGTERM and SIGHUP (the hangup of a terminal): the first signal asks the program to stop,
// the second ends it at once. Work in flight may take hours, so it gets a grace period after which it is abandoned.
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>

namespace pt {

inline constexpr int exit_interrupted = 130;  // exit code: 128 + SIGINT, also for SIGTERM and SIGHUP

class Interrupt {
public:
    // Handles SIGINT, SIGTERM and SIGHUP while this object lives. A process has at most one Interrupt at a time.
    explicit Interrupt(std::chrono::milliseconds grace = std::chrono::seconds(1));
    ~Interrupt();
    Interrupt(const Interrupt&) = delete;
    Interrupt& operator=(const Interrupt&) = delete;

    // Whether SIGINT, SIGTERM or SIGHUP has arrived.
    bool requested() const;
    // Sets a function `end` for overdue programs: if the program still runs `grace` after a signal, `end` is called on
    // a thread of its own and the process exits with the code that it returns; without `end`, with exit_interrupted.
    void when_overdue(std::function<int()> end);
    // Stops watching for overdue work, so that `end` is not called afterwards; if `end` is running already, this call
    // does not return. To be called before the program exits and before anything that `end` uses is destroyed.
    void begin_end();

private:
    void watch();

    std::chrono::milliseconds grace_;
    std::function<int()> end_;
    std::mutex mutex_;
    std::condition_variable changed_;
    bool is_ending_ = false;   // set by begin_end: the interrupted program ends by itself, in time
    bool is_overdue_ = false;  // set when the grace period after a signal is over: `end_` is called
    bool is_over_ = false;
    std::thread watcher_;
};

}  // namespace pt
