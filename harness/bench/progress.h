// How far a command is, on stderr: on a terminal a bar that is written over, "time [#####---] 12/40  0:31 elapsed,
// about 2:10 left  CELL"; in a log now and then a line, "[12/40] time: 0:31 elapsed, about 2:10 left  CELL".
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <string>

namespace pt {

// Seconds of a clock that is never set, for durations. It counts from no date.
double steady_seconds();

// How long what is left will take, from what was measured: steps of one name are taken to last as long as those before
// them; steps of a name that has none yet, as long as their size says at the rate of the names that have.
class TimeLeft {
public:
    // Tells that `steps` of this name are to come; `size`, above 0, is how large each of them is beside those of other
    // names.
    void expect(const std::string& name, std::size_t steps, double size);
    // A step was measured: one of those to come, or (`was_expected` false) one of an earlier session.
    void took(const std::string& name, double seconds, bool was_expected = true);
    // Takes a step out of the estimate: it will not come after all.
    void drop(const std::string& name);

    // Seconds that are left; nothing if nothing was measured yet.
    std::optional<double> seconds() const;

private:
    struct Name {
        std::size_t left = 0;
        double size = 1;
        std::size_t measured = 0;
        double total = 0;  // seconds
    };
    std::map<std::string, Name> names_;
};

class Progress {
public:
    enum class Lines { shown, hidden };

    // `what` names the phase; `total` steps are expected. Nothing is shown in the first `patience` seconds, and so
    // nothing at all of what takes no longer.
    Progress(std::string what, std::size_t total, Lines lines = Lines::shown, double patience = 0);
    // Tells that a step of that name begins: a terminal says so, a log does not.
    void begin(const std::string& name);
    // Tells that the step is done. The steps so far are taken to say how long the others last.
    void step(const std::string& name);
    // Tells that the step is done. `seconds_left` is called only where a line is shown.
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
    double last_shown_ = -1e9;    // long ago
    std::optional<double> left_;  // seconds, as last told
    bool is_terminal_;
};

// Takes away what stands on a terminal's line.
inline constexpr const char* erase_line = "\r\033[K";

// Prints a line on stderr, in the place of a bar that may stand there; the bar goes on below.
void say_below_progress(const std::string& line);

// A duration as "0:07", "12:34" or "3:04:05".
std::string clock_text(double seconds);

}  // namespace pt
