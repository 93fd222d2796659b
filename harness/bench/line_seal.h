// Lines of JSON that carry a checksum, so that a line that was changed, lost, moved or doubled is found when the file
// is read: the last member of each line, "check", is the FNV-1a of the line's text without it, begun with the checksum
// of the line before. analysis/ptbench/io/line_seal.py reads the same.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "variants/fnv1a.h"

namespace pt {

class LineSeal {
public:
    // The next line, without its end, of the text of an object. Precondition: it has a member, and ends with "}".
    std::string seal(std::string_view object);
    // What is wrong with `line` as the next one, in words; empty: it is as seal() made it.
    std::string fault(std::string_view line);

private:
    std::uint64_t before_ = fnv1a_start;  // the checksum of the line before
};

}  // namespace pt
