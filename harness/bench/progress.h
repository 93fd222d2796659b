// Shows the progress of a command on stderr: on a terminal as a bar that is overwritten, "time [#####---] 12/40 0:31
// elapsed, about 2:10 left CELL"; in a log as occasional lines, "[12/40] time: 0:31 elapsed, about 2:10 left CELL".
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <string>

namespace pt {

// The time in seconds on a monotonic clock, since an arbitrary start.
double steady_seconds();

// Estimates the remaining time of named steps. A step is expected to take as long as the measured steps of its name on
// average or, if there are none yet, a time in proportion to its size, at the rate of the other names.
class TimeLeft {
public:
    // Adds `steps` expected steps with this name. `size`, above 0, is their size relative to steps of other names.
    void expect(const std::string& name, std::size_t steps, double size);
    // Records a step's duration. `was_expected`: false for a step that `expect` did not count (an earlier session).
    void took(const std::string& name, double seconds, bool was_expected = true);
    // Removes an expected step from the estimate, because it will not be done.
    void drop(const std::string& name);

    // The estimated remaining time in seconds; none as long as nothing was measured.
    std::optional<double> seconds() const;

private:
    struct Name {
        std::size_t left = 0;
        double size = 1;
        std::size_t measured = 0;
        double total = 0;  // seconds that all measured steps of a name took
    };
    std::map<std::string, Name> names_;
};

class Progress {
public:
    enum class Lines { shown, hidden };

    // Starts the display of the phase `what` with `total` steps. Nothing is shown in the first `patience` seconds.
    Progress(std::string what, std::size_t total, Lines lines = Lines::shown, double patience = 0);
    // Shows on a terminal that a step with this name begins; a log gets no line.
    void begin(const std::string& name);
    // Counts a step as done; the remaining time follows from the mean duration of all steps so far.
    void step(const std::string& name);
    // Counts a step as done. `seconds_left` estimates the remaining time, and is called only if a line is shown.
    void step(const std::string& name, const std::function<std::optional<double>()>& seconds_left);

private:
    double pause(double elapsed) const;
    void draw(const std::string& name);

    std::string what_;
    std::size_t total_;
    Lines lines_;
    double patience_;
    std::size_t done_ = 0;
    double start_;
    double last_shown_ = -1e9;    // time at which a line was last shown, in seconds; none yet: -1e9
    std::optional<double> left_;  // the last estimate of the remaining time in seconds
    bool is_terminal_;
};

// The terminal's escape sequence that erases the current line.
inline constexpr const char* erase_line = "\r\033[K";

// Prints a line on stderr in place of the progress bar, which continues below the line.
void say_below_progress(const std::string& line);

// A duration as "0:07", "12:34" or "3:04:05".
std::string clock_text(double seconds);

}  // namespace pt
