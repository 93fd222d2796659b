// Standard error. Every line that ptbench says there goes through `say`, which never fails: a stream that is closed,
// full, or a pipe that nobody reads any more takes the line, not the run.
#pragma once

#include <exception>
#include <string_view>
#include <utility>

#include <fmt/format.h>

namespace pt {

// Writes all of the text to standard error at once, or as much as there is room for. May be called by a signal's
// handler.
void write_to_stderr(std::string_view text) noexcept;

// Prints on stderr, formatted as fmt::print does; the text has its own line ends.
template <class... Values>
void say(fmt::format_string<Values...> format, Values&&... values) noexcept {
    try {
        write_to_stderr(fmt::format(format, std::forward<Values>(values)...));
    } catch (const std::exception&) {  // no memory for the line
        write_to_stderr("ptbench: out of memory for a line\n");
    }
}

// Takes the place of standard streams that are closed, and writing to them goes on failing: else the next file that is
// opened would have the place, and lines for the stream would stand in that file. To be called first of all.
void occupy_standard_streams() noexcept;

}  // namespace pt
