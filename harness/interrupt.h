// Ctrl-C and SIGTERM: a first one asks for an end, a second one is the end. What is in flight may take hours, so it is
// given a moment to end by itself and is then abandoned.
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>

namespace pt {

inline constexpr int exit_interrupted = 130;  // as a shell says of Ctrl-C; here of SIGTERM too

class Interrupt {
public:
    // Handles the signals for as long as it lives; one of them at a time in a process.
    explicit Interrupt(std::chrono::milliseconds grace = std::chrono::seconds(1));
    ~Interrupt();
    Interrupt(const Interrupt&) = delete;
    Interrupt& operator=(const Interrupt&) = delete;

    // Whether there was a signal.
    bool requested() const;
    // What ends the program if it has not ended itself `grace` after a signal, in place of an exit with
    // exit_interrupted: `end` is called on a thread of its own, and the process exits with what it returns.
    void when_overdue(std::function<int()> end);
    // Before a program ends by itself, or what `end` needs goes: it is not called any more. Does not return where it
    // was called already.
    void begin_end();

private:
    void watch();

    std::chrono::milliseconds grace_;
    std::function<int()> end_;
    std::mutex mutex_;
    std::condition_variable changed_;
    bool is_ending_ = false;   // by itself
    bool is_overdue_ = false;  // by end_
    bool is_over_ = false;
    std::thread watcher_;
};

}  // namespace pt
