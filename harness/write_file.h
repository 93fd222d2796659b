// Writes a file whole: to a temporary name beside it, then renamed.
#pragma once

#include <string>

namespace pt {

// Creates missing folders. Throws MachineError if it cannot; then the old file, if any, is untouched.
void write_file(const std::string& file, const std::string& content);

}  // namespace pt
