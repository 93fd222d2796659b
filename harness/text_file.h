// Reads text files of users, whichever program saved them, as UTF-8 with LF line ends.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "harness/json_reader.h"

namespace pt {

// Returns the text without the byte order mark of UTF-8. Throws InputError for UTF-16 and UTF-32, which are recognised
// by their byte order marks, or by a byte 0 among the first four bytes. Error messages name `file`.
std::string_view without_byte_order_mark(std::string_view content, const std::string& file);

// A text without its byte order mark, and with every line's end (LF, CR LF, or CR alone) as LF.
std::string readable_text(std::string content, const std::string& file);

// Reads a file with `read_file` and returns its text without byte order mark and with LF line ends.
std::string read_text_file(const std::string& path, std::uint64_t largest = largest_input);

}  // namespace pt
