#include <algorithm>
#include <sstream>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "harness/failure.h"
#include "harness/mesh/obj_materials.h"
#include "harness/mesh/text_numbers.h"
#include "harness/words.h"

namespace pt {

namespace {

constexpr std::size_t most_materials = 10000;

// Strips a trailing comma from a number, as some programs write them in MTL files.
std::string without_comma(const std::string& word) {
    return word.size() > 1 && word.back() == ',' ? word.substr(0, word.size() - 1) : word;
}

// Whether an MTL keyword is followed by the name of a material or file, which may contain #.
bool has_name(const std::string& key) {
    return key == "newmtl" || key.starts_with("map_") || key == "bump" || key == "disp" || key == "decal" ||
           key == "norm" || key == "refl";
}

MtlLine mtl_line(std::size_t number, const std::string& physical) {
    MtlLine line{number, {}};
    std::istringstream words(physical);
    for (std::string word; words >> word;) {
        const bool is_name = !line.words.empty() && has_name(in_lower_case(line.words[0]));
        const std::size_t comment = is_name ? std::string::npos : word.find('#');
        if (comment != 0) {
            word = word.substr(0, comment);
            line.words.push_back(is_name ? word : without_comma(word));
        }
        if (comment != std::string::npos) {
            break;
        }
    }
    return line;
}

void add_line(MtlMaterial& material, const std::string& key, MtlLine line) {
    const auto [known, is_new] = material.lines.try_emplace(key);
    if (!is_new && !std::equal(known->second.words.begin() + 1, known->second.words.end(), line.words.begin() + 1,
                               line.words.end())) {
        material.overruled.push_back(std::move(known->second));
    }
    known->second = std::move(line);
}

}  // namespace

std::string without_comment(const std::string& name) {
    std::size_t end = name.find(" #");
    while (end != std::string::npos && end > 0 && name[end - 1] == ' ') {
        end -= 1;
    }
    return name.substr(0, end);
}

std::string MtlLine::text() const { return fmt::format("{}", fmt::join(words, " ")); }

std::vector<MtlMaterial> parse_mtl(std::string_view content, const std::string& file) {
    std::vector<MtlMaterial> materials;
    std::istringstream stream{std::string(content)};
    std::string physical;
    for (std::size_t number = 1; std::getline(stream, physical); ++number) {
        MtlLine line = mtl_line(number, physical);
        if (line.words.empty()) {
            continue;
        }
        const std::string key = in_lower_case(line.words[0]);
        if (key == "newmtl" && line.words.size() > 1 && materials.size() < most_materials) {
            const std::string name = fmt::format("{}", fmt::join(line.words.begin() + 1, line.words.end(), " "));
            materials.push_back({.name = name, .line = number, .lines = {}, .overruled = {}});
        } else if (key == "newmtl" || materials.empty()) {
            throw InputError(
                file, fmt::format("line {}", number), excerpt(line.text()),
                fmt::format("newmtl and a name, at most {} of them, and what belongs to it", most_materials));
        } else {
            add_line(materials.back(), key, std::move(line));
        }
    }
    return materials;
}

}  // namespace pt
