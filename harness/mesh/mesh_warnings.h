// What a reader of meshes says of a file that it does not take as it stands.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace pt {

// A file can be odd in every line: what is said of many places is kept once, with the first of them.
class MeshWarnings {
public:
    void add(std::string_view place, std::string_view text);

    // The warnings, "PLACE: TEXT", one line each, in the order in which they came; how many places more there are
    // stands behind each.
    std::vector<std::string> messages() const;

private:
    struct Warning {
        std::string place, text;
        std::size_t count = 0;
    };
    static constexpr std::size_t most_kept = 20;

    std::vector<Warning> kept_;
    std::size_t not_kept_ = 0;
};

}  // namespace pt
