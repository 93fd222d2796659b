// A file that one process at a time may hold: the kernel drops the lock when the process ends, however it ends.
#pragma once

#include <string>

namespace pt {

class LockedFile {
public:
    // Opens `file`, to read and to append, or creates it. Throws MachineError if it cannot, or if another process has
    // it; the file is then as it was.
    explicit LockedFile(std::string file);
    ~LockedFile();
    LockedFile(const LockedFile&) = delete;
    LockedFile& operator=(const LockedFile&) = delete;

    int descriptor() const { return descriptor_; }
    std::size_t size() const;
    // Removes the file. This process holds its lock, so no other one is using it.
    void remove() const;

private:
    std::string file_;
    int descriptor_ = -1;
};

}  // namespace pt
