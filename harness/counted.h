// Numbers of things in words: "1 thread", "2 threads".
#pragma once

#include <cstddef>
#include <string>

#include <fmt/format.h>

namespace pt {

// `noun` in the singular; its plural has an s more.
inline std::string counted(std::size_t count, const std::string& noun) {
    return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

}  // namespace pt
