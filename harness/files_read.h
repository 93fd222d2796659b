// Keeps track of the files that this call has read, so that no command writes over one of them, under whichever name.
#pragma once

#include <cstdint>
#include <string>

#include <sys/stat.h>

namespace pt {

// Records that this call has read a file; called by read_file.
void note_read(const struct stat& status);

// Throws InputError if this call has read `file`, the value of the option `flag`: it is a scene, or a file that a scene
// names. To be asked after all input has been read and before any output is written.
void refuse_source(const std::string& file, const std::string& flag = "--out");

// Reads an output file of an earlier call that this call may replace; such a file does not count as read.
std::string read_earlier_output(const std::string& file, std::uint64_t largest);

}  // namespace pt
