#include "harness/bench/line_seal.h"

#include <fmt/format.h>

namespace pt {

namespace {

std::string ending_of(std::uint64_t check) { return fmt::format(R"(,"check":"{:016x}"}})", check); }

}  // namespace

std::string LineSeal::seal(std::string_view object) {
    before_ = fnv1a(object, before_);
    return std::string(object.substr(0, object.size() - 1)) + ending_of(before_);
}

std::string LineSeal::fault(std::string_view line) {
    const std::size_t ending = ending_of(0).size();
    if (line.size() <= ending || !line.substr(line.size() - ending).starts_with(R"(,"check":")")) {
        return "no checksum at its end: it was changed, or an older ptbench wrote it";
    }
    const std::string text = std::string(line.substr(0, line.size() - ending)) + "}";
    before_ = fnv1a(text, before_);
    return line.ends_with(ending_of(before_)) ? ""
                                              : "another text than its checksum's: it was changed, or a line before it "
                                                "was lost, moved or doubled";
}

}  // namespace pt
