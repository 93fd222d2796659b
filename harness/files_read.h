// Which files this call has read: a command never writes over one of them, whatever name it goes by.
#pragma once

#include <cstdint>
#include <string>

#include <sys/stat.h>

namespace pt {

// Notes that read_file has read this file.
void note_read(const struct stat& status);

// Throws InputError if `file`, the value of the option `flag`, was read by this call: it is a scene, or one that a
// scene names. To be asked once everything is read, and before anything is written.
void refuse_source(const std::string& file, const std::string& flag = "--out");

// Reads a file that an earlier call may have written and this one may replace; it does not count as read.
std::string read_earlier_output(const std::string& file, std::uint64_t largest);

}  // namespace pt
