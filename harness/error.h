// The two ways in which a command can fail that are not a failed check: the input is wrong (exit code 2), or the
// machine failed (exit code 3). Each carries one clear line for the user.
#pragma once

#include <stdexcept>
#include <string>

namespace pt {

inline constexpr int exit_good = 0;
inline constexpr int exit_check_failed = 1;
inline constexpr int exit_bad_input = 2;
inline constexpr int exit_machine_failed = 3;

class InputError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
    // "FILE: PLACE: found FOUND, allowed: ALLOWED"
    InputError(const std::string& file, const std::string& place, const std::string& found, const std::string& allowed)
        : std::runtime_error(file + ": " + place + ": found " + found + ", allowed: " + allowed) {}
};

class MachineError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

}  // namespace pt
