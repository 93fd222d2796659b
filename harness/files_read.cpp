#include "harness/files_read.h"

#include <mutex>
#include <set>
#include <utility>

#include "harness/error.h"

namespace pt {

namespace {

using FileId = std::pair<dev_t, ino_t>;

struct FilesRead {
    std::mutex mutex;  // scenes may be read by several threads
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
    files.ids.emplace(status.st_dev, status.st_ino);
}

void refuse_source(const std::string& file, const std::string& flag) {
    struct stat status {};
    if (::stat(file.c_str(), &status) != 0) {
        return;
    }
    FilesRead& files = files_read();
    const std::lock_guard lock(files.mutex);
    if (files.ids.contains({status.st_dev, status.st_ino})) {
        throw InputError(flag, "file name", "\"" + file + "\", which this call reads", "another file");
    }
}

}  // namespace pt
