// Preloaded into a program: logs what it does to the files of a folder, and kills it in the middle of that. Operations
// are writes (one each, whatever their size) and fsync, ftruncate, rename, unlink.
//   KILL_AT_FOLDER     the folder
//   KILL_AT_LOG        a file that gets "OPERATION NAME\n" before each, outside of the folder
//   KILL_AT_OPERATION  the number of the operation, from 0, at which the process kills itself; unset: none
//   KILL_AT_PART       of a write, the part of its bytes that are written first; else 0: before it, 1: after it
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

#include <dlfcn.h>
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace {

std::string variable(const char* name) {
    const char* const value = std::getenv(name);
    return value != nullptr ? value : "";
}

long operations = 0;

bool is_inside(const std::string& path) {
    static const std::string folder = variable("KILL_AT_FOLDER");
    return !folder.empty() && path.rfind(folder, 0) == 0;
}

std::string path_of(int descriptor) {
    char link[64], path[PATH_MAX + 1];
    std::snprintf(link, sizeof link, "/proc/self/fd/%d", descriptor);
    const ssize_t length = ::readlink(link, path, PATH_MAX);
    return length > 0 ? std::string(path, static_cast<std::size_t>(length)) : "";
}

// Whether the process ends in this operation.
bool is_last(const char* operation, const std::string& path) {
    static const std::string log = variable("KILL_AT_LOG");
    static const std::string at = variable("KILL_AT_OPERATION");
    if (!log.empty()) {
        const std::string line = std::string(operation) + " " + path.substr(path.rfind('/') + 1) + "\n";
        const int file = ::open(log.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
        (void)!::syscall(SYS_write, file, line.data(), line.size());
        ::close(file);
    }
    return !at.empty() && operations++ == std::atol(at.c_str());
}

double part() { return std::atof(variable("KILL_AT_PART").c_str()); }

[[noreturn]] void die() {
    ::syscall(SYS_kill, ::getpid(), SIGKILL);
    while (true) {
        ::pause();
    }
}

template <class Function>
Function next(Function, const char* name) {
    return reinterpret_cast<Function>(::dlsym(RTLD_NEXT, name));
}

// Kills before or after `call`, or does only that.
template <class Call>
auto around(const char* operation, const std::string& path, const Call& call) {
    const bool ends = is_inside(path) && is_last(operation, path);
    if (ends && part() < 0.5) {
        die();
    }
    const auto result = call();
    if (ends) {
        die();
    }
    return result;
}

}  // namespace

extern "C" {

ssize_t write(int descriptor, const void* bytes, size_t size) {
    const std::string path = path_of(descriptor);
    if (is_inside(path) && is_last("write", path)) {
        const auto first = static_cast<size_t>(part() * static_cast<double>(size));
        (void)!::syscall(SYS_write, descriptor, bytes, first);
        die();
    }
    return ::syscall(SYS_write, descriptor, bytes, size);
}

int fsync(int descriptor) {
    return around("fsync", path_of(descriptor), [&] { return next(&::fsync, "fsync")(descriptor); });
}

int ftruncate(int descriptor, off_t size) noexcept {
    return around("ftruncate", path_of(descriptor), [&] { return next(&::ftruncate, "ftruncate")(descriptor, size); });
}

int rename(const char* from, const char* to) noexcept {
    return around("rename", from, [&] { return next(&::rename, "rename")(from, to); });
}

int unlink(const char* path) noexcept {
    return around("unlink", path, [&] { return next(&::unlink, "unlink")(path); });
}
}
