// Writes a file whole: to a temporary name beside it, onto the disk, then renamed.
#pragma once

#include <cstdint>
#include <string>

namespace pt {

// Throws InputError if `file`, the value of the option `flag`, is there and no regular file (a folder, a device, a
// pipe), or could not be made because a part of its path is a file. A link to a regular file is good: that file is
// meant.
void check_output_file(const std::string& file, const std::string& flag = "--out");

// Creates missing folders. Throws MachineError if it cannot be written, or what check_output_file refuses is there;
// then the old file, if any, is untouched.
void write_file(const std::string& file, const std::string& content);

// Which file there is under a name, and in which state: two stamps differ if somebody wrote it, or another in its
// place.
struct FileStamp {
    bool exists = false;
    std::uint64_t device = 0, inode = 0;
    std::int64_t size = 0, seconds = 0, nanoseconds = 0;
    bool operator==(const FileStamp&) const = default;
};
FileStamp stamp_of(const std::string& file);

// Removes what processes that were killed while they wrote `file` left beside it. Nobody else may be writing it.
void remove_partial_files(const std::string& file);

}  // namespace pt
