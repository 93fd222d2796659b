#include "harness/write_file.h"

#include <filesystem>
#include <fstream>

#include <unistd.h>

#include "harness/error.h"

namespace pt {

void write_file(const std::string& file, const std::string& content) {
    const std::filesystem::path path(file);
    std::error_code ignored;
    if (path.has_parent_path()) {
        std::filesystem::create_directories(path.parent_path(), ignored);
    }
    const std::string partial = file + ".partial" + std::to_string(::getpid());
    {
        std::ofstream stream(partial, std::ios::binary);
        stream.write(content.data(), static_cast<std::streamsize>(content.size()));
        stream.close();
        if (!stream) {
            std::filesystem::remove(partial, ignored);
            throw MachineError(file + ": cannot be written (no such folder, no permission or disk full)");
        }
    }
    std::error_code failed;
    std::filesystem::rename(partial, path, failed);
    if (failed) {
        std::filesystem::remove(partial, ignored);
        throw MachineError(file + ": cannot be written: " + failed.message());
    }
}

}  // namespace pt
