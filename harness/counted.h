#pragma once

#include <cstddef>
#include <string>

#include <fmt/format.h>

namespace pt {

// Returns a number with a noun, given in the singular, which gets an s in the plural: "1 thread", "2 threads".
inline std::string counted(std::size_t count, const std::string& noun) {
    return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

}  // namespace pt
