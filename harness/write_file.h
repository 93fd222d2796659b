// Writes files atomically: to a temporary name beside the file, synced to disk, then renamed.
#pragma once

#include <cstdint>
#include <string>

namespace pt {

// Throws InputError if `file`, the value of the option `flag`, cannot be written as a regular file: it is a folder, a
// device or a pipe, a part of its path is a file, or its name cannot be used (empty, too long, control characters). A
// symbolic link to a regular file is allowed; the file that it leads to is written.
void check_output_file(const std::string& file, const std::string& flag = "--out");

// Writes `content` to `file` and creates missing folders. Throws MachineError if the file cannot be written or
// check_output_file would refuse its name; an existing file is then left unchanged.
void write_file(const std::string& file, const std::string& content);

// Identifies a file and its state: two stamps of the same name differ if the file was written or replaced in between.
struct FileStamp {
    bool exists = false;
    std::uint64_t device = 0, inode = 0;
    std::int64_t size = 0, seconds = 0, nanoseconds = 0;
    bool operator==(const FileStamp&) const = default;
};
FileStamp stamp_of(const std::string& file);

// Removes the temporary files that killed processes left beside `file`. No other process may be writing `file`.
void remove_partial_files(const std::string& file);

}  // namespace pt
