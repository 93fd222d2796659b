// A file that one process at a time has: the kernel drops the lock when the process ends, however it ends.
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
    // Nobody else can have the lock of what is removed here, so nobody's file is taken away.
    void remove() const;

private:
    std::string file_;
    int descriptor_ = -1;
};

}  // namespace pt
