// Whether there is a program at a path: what looks for NVIDIA's tools asks it of each place.
#pragma once

#include <filesystem>

#include <unistd.h>

namespace pt::cuda {

inline bool is_program(const std::filesystem::path& path) {
    return ::access(path.c_str(), X_OK) == 0 && std::filesystem::is_regular_file(path);
}

}  // namespace pt::cuda
