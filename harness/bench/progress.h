// "[i/N] 0:31 elapsed, about 2:10 left  CELL" on stderr: in place on a terminal, now and then otherwise.
#pragma once

#include <cstddef>
#include <string>

namespace pt {

// Seconds since 1970.
double seconds_now();

class Progress {
public:
    // `what` names the phase; `total` steps are expected.
    Progress(std::string what, std::size_t total);
    void step(const std::string& name);

private:
    std::string what_;
    std::size_t total_;
    std::size_t done_ = 0;
    double start_;
    double last_shown_ = 0;
    bool is_terminal_;
};

}  // namespace pt
