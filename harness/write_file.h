// Writes a file whole: to a temporary name beside it, onto the disk, then renamed.
#pragma once

#include <string>

namespace pt {

// Throws InputError if `file`, the value of the option `flag`, is there and no regular file (a folder, a device, a
// pipe), or could not be made because a part of its path is a file. A link to a regular file is good: that file is
// meant.
void check_output_file(const std::string& file, const std::string& flag = "--out");

// Creates missing folders. Throws MachineError if it cannot be written, or what check_output_file refuses is there;
// then the old file, if any, is untouched.
void write_file(const std::string& file, const std::string& content);

// Removes what processes that were killed while they wrote `file` left beside it. Nobody else may be writing it.
void remove_partial_files(const std::string& file);

}  // namespace pt
