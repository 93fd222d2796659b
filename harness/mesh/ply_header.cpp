#include "harness/mesh/ply_header.h"

#include <algorithm>

#include <fmt/format.h>

#include "harness/failure.h"
#include "harness/mesh/text_numbers.h"
#include "harness/text_file.h"
#include "harness/words.h"

namespace pt {

namespace {

constexpr std::pair<std::string_view, PlyType> ply_type_names[] = {
    {"char", PlyType::int8},       {"int8", PlyType::int8},       {"uchar", PlyType::uint8},
    {"uint8", PlyType::uint8},     {"short", PlyType::int16},     {"int16", PlyType::int16},
    {"ushort", PlyType::uint16},   {"uint16", PlyType::uint16},   {"int", PlyType::int32},
    {"int32", PlyType::int32},     {"uint", PlyType::uint32},     {"uint32", PlyType::uint32},
    {"float", PlyType::float32},   {"float32", PlyType::float32}, {"double", PlyType::float64},
    {"float64", PlyType::float64},
};

std::vector<std::string_view> words_of(std::string_view line) {
    constexpr std::string_view white = " \t\r";
    std::vector<std::string_view> words;
    for (std::size_t at = line.find_first_not_of(white); at != std::string_view::npos;) {
        const std::size_t end = std::min(line.find_first_of(white, at), line.size());
        words.push_back(line.substr(at, end - at));
        at = line.find_first_not_of(white, end);
    }
    return words;
}

class PlyHeaderReader {
public:
    PlyHeaderReader(std::string_view content, const std::string& file) : content_(content), file_(file) {}

    PlyHeader read() {
        skip_byte_order_mark();
        if (next_line() != "ply") {
            fail("a file that does not begin with the line \"ply\"", "a PLY file");
        }
        for (std::string_view line = next_line(); line != "end_header"; line = next_line()) {
            add(line, words_of(line));
        }
        if (!has_format_) {
            fail("end_header", "a line \"format ..\" before it");
        }
        header_.end = at_;
        return header_;
    }

private:
    [[noreturn]] void fail(const std::string& found, const std::string& allowed) const {
        throw InputError(file_, fmt::format("line {}", line_), found, allowed);
    }

    void skip_byte_order_mark() {
        at_ = content_.size() - without_byte_order_mark(content_, file_).size();
        // Header lines of a PLY file end in CR alone only if the first CR has no LF behind it. A later LF byte does not
        // count, since in a binary file it may belong to a number.
        const std::size_t first = content_.find_first_of("\r\n", at_);
        const bool is_cr = first != std::string_view::npos && content_[first] == '\r';
        line_end_ = is_cr && !content_.substr(first + 1).starts_with('\n') ? '\r' : '\n';
    }

    std::string_view next_line() {
        constexpr std::size_t longest = 4096, most_lines = 4096;
        ++line_;
        const std::size_t end = content_.substr(0, at_ + std::min(longest, content_.size() - at_)).find(line_end_, at_);
        if (end == std::string_view::npos || line_ > most_lines) {
            fail("no end_header", "a header of at most 4096 lines of at most 4096 bytes, and end_header");
        }
        std::string_view line = content_.substr(at_, end - at_);
        at_ = end + 1;
        while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) {
            line.remove_suffix(1);
        }
        return line;
    }

    void add(std::string_view line, const std::vector<std::string_view>& words) {
        if (words.empty() || words[0] == "comment" || words[0] == "obj_info") {
            return;
        }
        if (words[0] == "format" && words.size() == 3) {
            add_format(words);
        } else if (words[0] == "element" && words.size() == 3) {
            add_element(words);
        } else if (words[0] == "property" && words.size() >= 3 && !header_.elements.empty()) {
            add_property(line, words);
        } else {
            fail(excerpt(line),
                 "format, element NAME COUNT, property TYPE NAME (after an element), comment or end_header");
        }
    }

    void add_format(const std::vector<std::string_view>& words) {
        constexpr std::string_view names[] = {"ascii", "binary_little_endian", "binary_big_endian"};
        const auto* found = std::find(std::begin(names), std::end(names), words[1]);
        if (found == std::end(names) || words[2] != "1.0" || has_format_) {
            fail(fmt::format("format {} {}", words[1], words[2]),
                 "once: ascii, binary_little_endian or binary_big_endian, 1.0");
        }
        header_.format = static_cast<PlyFormat>(found - names);
        has_format_ = true;
    }

    void add_element(const std::vector<std::string_view>& words) {
        const auto count = parse_number<decltype(PlyElement::count)>(words[2]);
        PlyElement element{std::string(words[1]), count.value_or(0), {}};
        if (!count) {
            fail(fmt::format("element {} {}", words[1], excerpt(words[2])), "a whole number of them");
        }
        for (const PlyElement& before : header_.elements) {
            if (before.name == element.name) {
                fail(fmt::format("element {} twice", element.name), "once");
            }
        }
        header_.elements.push_back(std::move(element));
    }

    PlyType type_of(std::string_view word) const {
        for (const auto& [name, type] : ply_type_names) {
            if (name == word) {
                return type;
            }
        }
        fail(fmt::format("type {}", excerpt(word)), "char, uchar, short, ushort, int, uint, float or double");
    }

    void add_property(std::string_view line, const std::vector<std::string_view>& words) {
        PlyProperty property;
        property.name = words.back();
        property.is_list = words[1] == "list";
        if (words.size() != (property.is_list ? 5u : 3u)) {
            fail(excerpt(line), "property TYPE NAME, or property list TYPE TYPE NAME");
        }
        property.type = type_of(words[words.size() - 2]);
        if (property.is_list) {
            property.count_type = type_of(words[2]);
            if (property.count_type >= PlyType::float32) {
                fail(excerpt(line), "a list with a whole number for its length");
            }
        }
        header_.elements.back().properties.push_back(std::move(property));
    }

    std::string_view content_;
    const std::string& file_;
    PlyHeader header_;
    bool has_format_ = false;
    std::size_t at_ = 0, line_ = 0;
    char line_end_ = '\n';
};

}  // namespace

std::size_t bytes_of(PlyType type) {
    constexpr std::size_t bytes[] = {1, 1, 2, 2, 4, 4, 4, 8};
    return bytes[static_cast<int>(type)];
}

PlyHeader read_ply_header(std::string_view content, const std::string& file) {
    return PlyHeaderReader(content, file).read();
}

}  // namespace pt
