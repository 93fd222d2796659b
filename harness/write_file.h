// Writes a file whole: to a temporary name beside it, onto the disk, then renamed.
#pragma once

#include <string>

namespace pt {

// Creates missing folders. Throws MachineError if it cannot; then the old file, if any, is untouched.
void write_file(const std::string& file, const std::string& content);

// Removes what processes that were killed while they wrote `file` left beside it. Nobody else may be writing it.
void remove_partial_files(const std::string& file);

}  // namespace pt
