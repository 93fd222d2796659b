#include "harness/bench/progress.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include <fmt/format.h>
#include <unistd.h>

namespace pt {

namespace {

std::string minutes(double seconds) {
    const long whole = std::lround(seconds);
    return fmt::format("{}:{:02}", whole / 60, whole % 60);
}

}  // namespace

double seconds_now() {
    return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

Progress::Progress(std::string what, std::size_t total)
    : what_(std::move(what)), total_(total), start_(seconds_now()), is_terminal_(::isatty(STDERR_FILENO) != 0) {}

void Progress::step(const std::string& name) {
    done_ += 1;
    const double now = seconds_now();
    if (!is_terminal_ && now - last_shown_ < 10 && done_ != total_) {
        return;
    }
    last_shown_ = now;
    const double elapsed = now - start_;
    const double left = elapsed / static_cast<double>(done_) * static_cast<double>(total_ - std::min(done_, total_));
    fmt::print(stderr, "{}[{}/{}] {}: {} elapsed, about {} left  {}{}", is_terminal_ ? "\r\033[K" : "", done_, total_,
               what_, minutes(elapsed), minutes(left), name, is_terminal_ && done_ != total_ ? "" : "\n");
    std::fflush(stderr);
}

}  // namespace pt
