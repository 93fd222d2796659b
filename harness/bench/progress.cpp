#include "harness/bench/progress.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "harness/say.h"

namespace pt {

namespace {

std::size_t terminal_width() {
    winsize size{};
    return ::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 1 ? size.ws_col : 80;
}

std::string bar_of(std::size_t done, std::size_t total) {
    constexpr std::size_t width = 20;
    const std::size_t filled = total == 0 ? width : std::min(width, width * done / total);
    return std::string(filled, '#') + std::string(width - filled, '-');
}

}  // namespace

double steady_seconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

std::string clock_text(double seconds) {
    const long whole = std::lround(seconds);
    return whole < 3600 ? fmt::format("{}:{:02}", whole / 60, whole % 60)
                        : fmt::format("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60);
}

void say_below_progress(const std::string& line) {
    say("{}{}\n", ::isatty(STDERR_FILENO) != 0 ? erase_line : "", line);
}

void TimeLeft::expect(const std::string& name, std::size_t steps, double size) {
    names_[name].left += steps;
    names_[name].size = size;
}

void TimeLeft::took(const std::string& name, double seconds, bool was_expected) {
    Name& entry = names_[name];
    entry.measured += 1;
    entry.total += seconds;
    entry.left -= was_expected && entry.left > 0 ? 1 : 0;
}

void TimeLeft::drop(const std::string& name) {
    Name& entry = names_[name];
    entry.left -= entry.left > 0 ? 1 : 0;
}

std::optional<double> TimeLeft::seconds() const {
    double sizes = 0, means = 0;  // sums of step sizes and mean step times, over names with at least one measured step
    for (const auto& [name, entry] : names_) {
        if (entry.measured > 0) {
            sizes += entry.size;
            means += entry.total / static_cast<double>(entry.measured);
        }
    }
    if (sizes <= 0) {
        return std::nullopt;
    }
    double left = 0;
    for (const auto& [name, entry] : names_) {
        const double each =
            entry.measured > 0 ? entry.total / static_cast<double>(entry.measured) : entry.size * means / sizes;
        left += static_cast<double>(entry.left) * each;
    }
    return left;
}

Progress::Progress(std::string what, std::size_t total, Lines lines, double patience)
    : what_(std::move(what)),
      total_(total),
      lines_(lines),
      patience_(patience),
      start_(steady_seconds()),
      is_terminal_(::isatty(STDERR_FILENO) != 0) {}

// Seconds between two progress lines of a log, in proportion to the elapsed time: a run of days still has a short log.
double Progress::pause(double elapsed) const { return is_terminal_ ? 0.2 : std::clamp(elapsed / 50, 10.0, 600.0); }

void Progress::begin(const std::string& name) {
    const double now = steady_seconds();
    if (is_terminal_ && lines_ == Lines::shown && now - start_ >= patience_ && now - last_shown_ >= pause(0)) {
        draw(name);
    }
}

void Progress::step(const std::string& name) {
    step(name, [this]() -> std::optional<double> {
        return (steady_seconds() - start_) / static_cast<double>(done_) *
               static_cast<double>(total_ - std::min(done_, total_));
    });
}

void Progress::step(const std::string& name, const std::function<std::optional<double>()>& seconds_left) {
    done_ += 1;
    const double now = steady_seconds();
    if (lines_ == Lines::hidden || now - start_ < patience_ ||
        (now - last_shown_ < pause(now - start_) && done_ != total_)) {
        return;
    }
    left_ = seconds_left();
    draw(name);
    if (is_terminal_ && done_ == total_) {
        say("\n");
    }
}

void Progress::draw(const std::string& name) {
    last_shown_ = steady_seconds();
    const std::string times = fmt::format("{} elapsed, {} left  {}", clock_text(last_shown_ - start_),
                                          left_ ? "about " + clock_text(*left_) : "unknown time", name);
    if (is_terminal_) {
        const std::string line = fmt::format("{} [{}] {}/{}  {}", what_, bar_of(done_, total_), done_, total_, times);
        // The progress bar is cut to the terminal's width, because a wrapped line could not be overwritten.
        say("{}{}", erase_line, line.substr(0, terminal_width() - 1));
    } else {
        say("[{}/{}] {}: {}\n", done_, total_, what_, times);
    }
}

}  // namespace pt
