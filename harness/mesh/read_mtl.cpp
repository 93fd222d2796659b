#include <algorithm>
#include <cctype>
#include <sstream>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "harness/error.h"
#include "harness/mesh/obj_materials.h"
#include "harness/mesh/text_numbers.h"

namespace pt {

namespace {

constexpr std::size_t most_materials = 10000;

std::string in_lower_case(std::string word) {
    std::transform(word.begin(), word.end(), word.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return word;
}

// Some programs put commas between numbers.
std::string without_comma(const std::string& word) {
    return word.size() > 1 && word.back() == ',' ? word.substr(0, word.size() - 1) : word;
}

}  // namespace

std::string MtlLine::text() const { return fmt::format("{}", fmt::join(words, " ")); }

std::vector<MtlMaterial> parse_mtl(std::string_view content, const std::string& file) {
    std::vector<MtlMaterial> materials;
    std::istringstream stream{std::string(content)};
    std::string physical;
    for (std::size_t number = 1; std::getline(stream, physical); ++number) {
        std::istringstream text(physical.substr(0, physical.find('#')));
        MtlLine line{number, {}};
        for (std::string word; text >> word;) {
            line.words.push_back(without_comma(word));
        }
        if (line.words.empty()) {
            continue;
        }
        const std::string key = in_lower_case(line.words[0]);
        if (key == "newmtl" && line.words.size() > 1 && materials.size() < most_materials) {
            const std::string name = fmt::format("{}", fmt::join(line.words.begin() + 1, line.words.end(), " "));
            materials.push_back({.name = name, .line = number, .lines = {}});
        } else if (key == "newmtl" || materials.empty()) {
            throw InputError(
                file, fmt::format("line {}", number), excerpt(line.text()),
                fmt::format("newmtl and a name, at most {} of them, and what belongs to it", most_materials));
        } else {
            materials.back().lines[key] = std::move(line);
        }
    }
    return materials;
}

}  // namespace pt
