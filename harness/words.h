// Parses words of command lines and text files: numbers, lists, and letter case.
#pragma once

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace pt {

// Parses a word as a number with std::from_chars. Returns nothing if the word is no number, is out of T's range, or has
// further characters behind the number.
template <class T>
std::optional<T> parse_number(std::string_view word) {
    T number{};
    const char* const last = word.data() + word.size();
    const auto [end, error] = std::from_chars(word.data(), last, number);
    return error == std::errc() && end == last ? std::optional(number) : std::nullopt;
}

// Parses a finite number, which may have the sign +.
inline std::optional<double> parse_finite(std::string_view word) {
    const auto number = parse_number<double>(word.substr(word.starts_with('+') ? 1 : 0));
    return number && std::isfinite(*number) ? number : std::nullopt;
}

// Parses two whole numbers such as "64x48", where `between` is 'x'.
inline std::optional<std::pair<std::uint32_t, std::uint32_t>> parse_pair(std::string_view word, char between) {
    const std::size_t middle = std::min(word.find(between), word.size());
    const auto first = parse_number<std::uint32_t>(word.substr(0, middle));
    const auto second = parse_number<std::uint32_t>(word.substr(std::min(middle + 1, word.size())));
    return first && second ? std::optional(std::pair(*first, *second)) : std::nullopt;
}

// Splits a text at its commas: "a,b,,c" becomes {"a", "b", "", "c"}.
inline std::vector<std::string> split_at_commas(const std::string& text) {
    std::vector<std::string> parts;
    for (std::size_t start = 0; start <= text.size();) {
        const std::size_t comma = std::min(text.find(',', start), text.size());
        parts.push_back(text.substr(start, comma - start));
        start = comma + 1;
    }
    return parts;
}

// Returns the text with the letters A to Z in lower case.
inline std::string in_lower_case(std::string text) {
    for (char& c : text) {
        c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    }
    return text;
}

}  // namespace pt
