// JSON lines with a chained checksum, by which a reader finds a line that was changed, lost, moved or doubled. The last
// member of each line, "check", is the FNV-1a hash of the rest of the line, seeded with the previous line's checksum.
// analysis/ptbench/io/line_seal.py reads the same format.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "variants/fnv1a.h"

namespace pt {

class LineSeal {
public:
    // Returns the text of a JSON object as the next line, with its checksum and without a newline. Precondition: the
    // object has a member, and the text ends with "}".
    std::string seal(std::string_view object);
    // Says why `line` cannot be the next sealed line of a file; empty if it can.
    std::string fault(std::string_view line);

private:
    std::uint64_t before_ = fnv1a_start;  // checksum of the sealed file's last line so far
};

}  // namespace pt
