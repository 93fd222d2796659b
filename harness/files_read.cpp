#include "harness/files_read.h"

#include <mutex>
#include <set>
#include <tuple>

#include "harness/failure.h"

namespace pt {

namespace {

// The identity of a file includes its size and time, since the inode number of a removed file may be used again.
using FileId = std::tuple<dev_t, ino_t, off_t, time_t, long>;

FileId id_of(const struct stat& status) {
    return {status.st_dev, status.st_ino, status.st_size, status.st_mtim.tv_sec, status.st_mtim.tv_nsec};
}

struct FilesRead {
    std::mutex mutex;  // guards `ids`, since several threads may read scenes
    std::set<FileId> ids;
};

FilesRead& files_read() {
    static FilesRead files;
    return files;
}

}  // namespace

void note_read(const struct stat& status) {
    FilesRead& files = files_read();
    const std::lock_guard lock(files.mutex);
    files.ids.insert(id_of(status));
}

void refuse_source(const std::string& file, const std::string& flag) {
    struct stat status {};
    if (::stat(file.c_str(), &status) != 0) {
        return;
    }
    FilesRead& files = files_read();
    const std::lock_guard lock(files.mutex);
    if (files.ids.contains(id_of(status))) {
        throw InputError(flag, "file name", "\"" + file + "\", which this call reads", "another file");
    }
}

}  // namespace pt
