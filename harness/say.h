// Writes ptbench's messages to standard error through `say`, which never fails: if the stream is closed, full, or a
// pipe without a reader, the message is lost but the run goes on.
#pragma once

#include <exception>
#include <string_view>
#include <utility>

#include <fmt/format.h>

namespace pt {

// Writes the text to standard error at once, or as much of it as there is room for. May be called in a signal handler.
void write_to_stderr(std::string_view text) noexcept;

// Prints on stderr, formatted as fmt::print does; the text contains its own newlines.
template <class... Values>
void say(fmt::format_string<Values...> format, Values&&... values) noexcept {
    try {
        write_to_stderr(fmt::format(format, std::forward<Values>(values)...));
    } catch (const std::exception&) {  // memory for the formatted message has run out
        write_to_stderr("ptbench: out of memory for a line\n");
    }
}

// Opens /dev/null, in a mode in which each use still fails, in place of standard streams that are closed. Otherwise the
// next file opened would get a stream's descriptor, and messages would go into it. To be called first in main.
void occupy_standard_streams() noexcept;

}  // namespace pt
