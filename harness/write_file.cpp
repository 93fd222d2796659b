#include "harness/write_file.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <vector>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "harness/failure.h"

namespace pt {

namespace {

// Writes all bytes and syncs them to disk; returns false and sets errno on failure.
bool write_through(int descriptor, const std::string& content) {
    for (std::size_t done = 0; done < content.size();) {
        const ssize_t written = ::write(descriptor, content.data() + done, content.size() - done);
        if (written < 0 && errno != EINTR) {
            return false;
        }
        done += static_cast<std::size_t>(std::max<ssize_t>(written, 0));
    }
    return ::fsync(descriptor) == 0;
}

// Writes a new file; returns 0, or the errno of the call that failed.
int write_new(const std::string& file, const std::string& content) {
    const int descriptor = ::open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (descriptor < 0) {
        return errno;
    }
    int failed = write_through(descriptor, content) ? 0 : errno;
    if (::close(descriptor) != 0 && failed == 0) {
        failed = errno;
    }
    return failed;
}

// Syncs a folder, so that a new name in it is on the disk too. Errors are ignored, since some file systems cannot sync
// a folder; the file's content is on the disk in any case.
void sync_folder(const std::filesystem::path& folder) {
    const int descriptor = ::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (descriptor >= 0) {
        (void)!::fsync(descriptor);
        ::close(descriptor);
    }
}

constexpr const char* partial_suffix = ".partial";  // suffix of a temporary file, before the process id

// Says why a regular file of that name cannot be written; an empty text means that nothing prevents it.
std::string obstacle(const std::string& file) {
    if (file.empty()) {
        return "no name";
    }
    // Limits in bytes on names and paths, with room for the suffixes of journals and temporary files.
    constexpr std::size_t longest_name = 200, longest_path = 3800;
    if (std::filesystem::path(file).filename().string().size() > longest_name || file.size() > longest_path) {
        return "a name of more than 200 bytes, or a path of more than 3800";
    }
    if (one_line(file) != file) {
        return "a name with control characters or bytes that are no UTF-8";
    }
    std::error_code failed;
    const std::filesystem::file_status status = std::filesystem::status(file, failed);
    if (std::filesystem::is_regular_file(status)) {
        return "";
    }
    if (std::filesystem::exists(status)) {
        return std::filesystem::is_directory(status) ? "a folder" : "no regular file (a device, a pipe or a socket)";
    }
    if (failed == std::errc::not_a_directory) {
        return "a path through a file that is no folder";
    }
    if (std::filesystem::is_symlink(std::filesystem::symlink_status(file, failed))) {
        return "a link to nothing";
    }
    return file.back() == '/' ? "the name of a folder" : "";
}

// Resolves a symbolic link, since renaming onto the link would replace the link and leave the file that it leads to.
std::string target_of(const std::string& file) {
    std::error_code failed;
    if (!std::filesystem::is_symlink(std::filesystem::symlink_status(file, failed))) {
        return file;
    }
    const std::filesystem::path target = std::filesystem::canonical(file, failed);
    return failed ? file : target.string();
}

}  // namespace

void check_output_file(const std::string& file, const std::string& flag) {
    if (const std::string found = obstacle(file); !found.empty()) {
        throw InputError(flag, "file name", "\"" + file + "\", " + found, "a file, new or regular");
    }
}

void write_file(const std::string& name, const std::string& content) {
    if (const std::string found = obstacle(name); !found.empty()) {
        throw MachineError(name + ": cannot be written: " + found);
    }
    const std::string file = target_of(name);
    const std::filesystem::path path(file);
    std::error_code unmade;
    if (path.has_parent_path()) {
        std::filesystem::create_directories(path.parent_path(), unmade);
    }
    const std::string partial = file + partial_suffix + std::to_string(::getpid());
    int failed = write_new(partial, content);
    if (failed == 0 && ::rename(partial.c_str(), file.c_str()) != 0) {
        failed = errno;
    }
    if (failed != 0) {
        std::error_code ignored;
        std::filesystem::remove(partial, ignored);
        throw MachineError(file + ": cannot be written: " + (unmade ? unmade.message() : std::strerror(failed)));
    }
    sync_folder(path.parent_path());
}

FileStamp stamp_of(const std::string& file) {
    struct stat status {};
    if (::stat(file.c_str(), &status) != 0) {
        return {};
    }
    return {.exists = true,
            .device = static_cast<std::uint64_t>(status.st_dev),
            .inode = static_cast<std::uint64_t>(status.st_ino),
            .size = status.st_size,
            .seconds = status.st_mtim.tv_sec,
            .nanoseconds = status.st_mtim.tv_nsec};
}

void remove_partial_files(const std::string& file) {
    const std::filesystem::path path(file);
    const std::string start = path.filename().string() + partial_suffix;
    const std::filesystem::path folder = path.has_parent_path() ? path.parent_path() : ".";
    std::vector<std::filesystem::path> found;
    std::error_code ignored;
    for (const auto& entry : std::filesystem::directory_iterator(folder, ignored)) {
        const std::string name = entry.path().filename().string();
        if (name.starts_with(start) && name.find_first_not_of("0123456789", start.size()) == std::string::npos) {
            found.push_back(entry.path());
        }
    }
    for (const std::filesystem::path& partial : found) {
        std::filesystem::remove(partial, ignored);
    }
}

}  // namespace pt
