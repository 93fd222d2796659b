// Numbers of things in words: "1 thread", "2 threads".
#pragma once

#include <cstddef>
#include <string>

#include <fmt/format.h>

namespace pt {

// A number with a noun, which is given in the singular and has an s more in the plural: "1 thread", "2 threads".
inline std::string counted(std::size_t count, const std::string& noun) {
    return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

}  // namespace pt
