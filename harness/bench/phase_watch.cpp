#include "harness/bench/phase_watch.h"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>

#include <fmt/format.h>
#include <unistd.h>

#include "harness/bench/progress.h"
#include "harness/say.h"

namespace pt {

namespace {

constexpr std::chrono::milliseconds pace(250);

double patience_of_environment() {
    const char* const text = std::getenv("PTBENCH_PATIENCE");
    return text != nullptr ? std::max(0.0, std::atof(text)) : PhaseLines::default_patience;
}

}  // namespace

PhaseLines::PhaseLines(std::string command, bool is_terminal, double patience)
    : command_(std::move(command)), is_terminal_(is_terminal), patience_(patience) {}

void PhaseLines::begin(const std::string& what, std::optional<double> expected, double now) {
    what_ = what;
    expected_ = expected;
    begun_ = now;
    next_ = now + patience_;
    is_over_ = false;
}

void PhaseLines::reached(double share, double now) {
    if (share > 0) {
        expected_ = (now - begun_) / share;
    }
}

std::string PhaseLines::times(double elapsed) const {
    const std::string so_far = clock_text(elapsed);
    if (!expected_) {
        return so_far + " so far";
    }
    return *expected_ >= elapsed ? fmt::format("{} elapsed, about {} left", so_far, clock_text(*expected_ - elapsed))
                                 : fmt::format("{} elapsed, where {} were expected", so_far, clock_text(*expected_));
}

std::string PhaseLines::due(double now) {
    if (is_over_ || now < next_) {
        return "";
    }
    const double elapsed = now - begun_;
    // The time between two progress lines is chosen as in the class Progress.
    next_ = now + (is_terminal_ ? 0.2 : std::clamp(elapsed / 50, 10.0, 600.0));
    return fmt::format("{}: {}: {}", command_, what_, times(elapsed));
}

PhaseWatch::PhaseWatch(const std::string& command)
    : is_terminal_(::isatty(STDERR_FILENO) != 0), lines_(command, is_terminal_, patience_of_environment()) {
    // The thread that displays phases blocks all signals, so that the kernel delivers them to the main thread.
    sigset_t all, kept;
    ::sigfillset(&all);
    ::pthread_sigmask(SIG_SETMASK, &all, &kept);
    thread_ = std::thread([this] {
        std::unique_lock lock(mutex_);
        while (!has_ended_.wait_for(lock, pace, [this] { return is_ended_; })) {
            tell();
        }
    });
    ::pthread_sigmask(SIG_SETMASK, &kept, nullptr);
}

PhaseWatch::~PhaseWatch() {
    end();
    {
        const std::lock_guard lock(mutex_);
        is_ended_ = true;
    }
    has_ended_.notify_one();
    thread_.join();
}

void PhaseWatch::begin(const std::string& what, std::optional<double> expected) {
    const std::lock_guard lock(mutex_);
    clear();
    lines_.begin(what, expected, steady_seconds());
    tell();
}

void PhaseWatch::reached(double share) {
    const std::lock_guard lock(mutex_);
    lines_.reached(share, steady_seconds());
}

void PhaseWatch::end() {
    const std::lock_guard lock(mutex_);
    lines_.end();
    clear();
}

// Prints the progress line if one is due. Precondition: mutex_ is locked.
void PhaseWatch::tell() {
    const std::string line = lines_.due(steady_seconds());
    if (!line.empty()) {
        say("{}{}{}", is_terminal_ ? erase_line : "", line, is_terminal_ ? "" : "\n");
        stands_ = is_terminal_;
    }
}

void PhaseWatch::clear() {
    if (stands_) {
        say("{}", erase_line);
        stands_ = false;
    }
}

}  // namespace pt
