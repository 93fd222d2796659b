#include "harness/locked_file.h"

#include <cerrno>
#include <cstring>
#include <filesystem>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "harness/failure.h"

namespace pt {

namespace {

// Whether the file's name still leads to the open file: the previous holder of the lock may have removed the file.
bool is_at(int descriptor, const std::string& file) {
    struct stat open {
    }, named{};
    return ::fstat(descriptor, &open) == 0 && ::stat(file.c_str(), &named) == 0 && open.st_dev == named.st_dev &&
           open.st_ino == named.st_ino;
}

}  // namespace

LockedFile::LockedFile(std::string file) : file_(std::move(file)) {
    const std::filesystem::path folder = std::filesystem::path(file_).parent_path();
    std::error_code unmade;
    if (!folder.empty()) {
        std::filesystem::create_directories(folder, unmade);
    }
    do {
        if (descriptor_ >= 0) {
            ::close(descriptor_);
        }
        descriptor_ = ::open(file_.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
        if (descriptor_ < 0) {
            const std::string reason = unmade ? unmade.message() : std::strerror(errno);
            throw MachineError(fmt::format("{}: cannot be written: {}", file_, reason));
        }
        if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
            const int reason = errno;
            ::close(descriptor_);
            throw MachineError(reason == EWOULDBLOCK
                                   ? fmt::format("{}: another run is writing it", file_)
                                   : fmt::format("{}: cannot be locked: {}", file_, std::strerror(reason)));
        }
    } while (!is_at(descriptor_, file_));
}

LockedFile::~LockedFile() { ::close(descriptor_); }

std::size_t LockedFile::size() const {
    struct stat status {};
    return ::fstat(descriptor_, &status) == 0 ? static_cast<std::size_t>(status.st_size) : 0;
}

void LockedFile::remove() const { ::unlink(file_.c_str()); }

}  // namespace pt
