// Files of text that people bring along, whichever program saved them: what every reader of text is handed.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "harness/json_reader.h"

namespace pt {

// The text without the byte order mark of UTF-8. Throws InputError for UTF-16 and UTF-32, by their marks, or by a zero
// among the first four bytes, which no text begins with. `file` is for the messages.
std::string_view without_byte_order_mark(std::string_view content, const std::string& file);

// A text without its byte order mark, and with every line's end (LF, CR LF, or CR alone) as LF.
std::string readable_text(std::string content, const std::string& file);

// The readable text of a file, by read_file.
std::string read_text_file(const std::string& path, std::uint64_t largest = largest_input);

}  // namespace pt
