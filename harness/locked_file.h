// A file locked by one process at a time; the kernel drops the lock when the process ends, in whichever way.
#pragma once

#include <string>

namespace pt {

class LockedFile {
public:
    // Opens `file` for reading and appending, or creates it, and locks it. Throws MachineError if the file cannot be
    // opened or another process has the lock; the file is then unchanged.
    explicit LockedFile(std::string file);
    ~LockedFile();
    LockedFile(const LockedFile&) = delete;
    LockedFile& operator=(const LockedFile&) = delete;

    int descriptor() const { return descriptor_; }
    std::size_t size() const;
    // Removes the locked file. The lock guarantees that no other process is using it.
    void remove() const;

private:
    std::string file_;
    int descriptor_ = -1;
};

}  // namespace pt
