// Ctrl-C, SIGTERM and the hangup of a terminal: a first one asks for an end, a second one is the end. What is in flight
// may take hours, so it is given a moment to end by itself and is then abandoned.
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>

namespace pt {

inline constexpr int exit_interrupted = 130;  // 128 + SIGINT, as shells report Ctrl-C; for the other two too

class Interrupt {
public:
    // Handles the interrupting signals while this object lives. A process has at most one Interrupt at a time.
    explicit Interrupt(std::chrono::milliseconds grace = std::chrono::seconds(1));
    ~Interrupt();
    Interrupt(const Interrupt&) = delete;
    Interrupt& operator=(const Interrupt&) = delete;

    // Whether there was an interrupting signal.
    bool requested() const;
    // If the program still runs `grace` after a signal, `end` is called on a thread of its own and the process exits
    // with what it returns. Without this call the process then exits with exit_interrupted.
    void when_overdue(std::function<int()> end);
    // Ends the watch, so that `end` is not called afterwards; if `end` is running already, this call does not return.
    // To be called before the program ends by itself and before anything that `end` uses is destroyed.
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
