// The two ways in which a command can fail other than by a failed check: the input is wrong (exit code 2), or the
// machine failed (exit code 3). The message of either error is one line for the user.
#pragma once

#include <stdexcept>
#include <string>

namespace pt {

inline constexpr int exit_good = 0;
inline constexpr int exit_check_failed = 1;
inline constexpr int exit_bad_input = 2;
inline constexpr int exit_machine_failed = 3;

// Makes a text one line that is safe on a terminal: control characters and bytes that are not UTF-8, which names of
// files and values may contain, are escaped as \x0a.
std::string one_line(const std::string& text);

class InputError : public std::runtime_error {
public:
    explicit InputError(const std::string& message) : std::runtime_error(one_line(message)) {}
    // An error of the form "FILE: PLACE: found FOUND, allowed: ALLOWED".
    InputError(const std::string& file, const std::string& place, const std::string& found, const std::string& allowed)
        : InputError(file + ": " + place + ": found " + found + ", allowed: " + allowed) {}
};

class MachineError : public std::runtime_error {
public:
    explicit MachineError(const std::string& message) : std::runtime_error(one_line(message)) {}
};

}  // namespace pt
