// Warnings of a mesh reader about parts of a file that it skips or reinterprets.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace pt {

// Collects warnings about a mesh file. Since every line may cause one, equal texts are kept once, with the first place.
class MeshWarnings {
public:
    void add(std::string_view place, std::string_view text);

    // The warnings, "PLACE: TEXT", by their first places; the number of further places follows each text.
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
