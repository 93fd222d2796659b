// Tells whether a path is an executable program; used in the search for NVIDIA's tools.
#pragma once

#include <filesystem>

#include <unistd.h>

namespace pt::cuda {

inline bool is_program(const std::filesystem::path& path) {
    return ::access(path.c_str(), X_OK) == 0 && std::filesystem::is_regular_file(path);
}

}  // namespace pt::cuda
