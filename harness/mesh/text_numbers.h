// Parses numbers in text mesh files, rounded once and independent of the locale.
#pragma once

#include <charconv>
#include <limits>
#include <string>
#include <string_view>

#include <fmt/format.h>

namespace pt {

// Parses a word that is a number and nothing else; false if it is not. Overflow gives infinity, underflow zero.
template <class T>
bool parse_real(std::string_view word, T& value) {
    if (word.size() > 1 && word[0] == '+' && word[1] != '-') {
        word.remove_prefix(1);
    }
    const auto [end, error] = std::from_chars(word.begin(), word.end(), value);
    if (error == std::errc::result_out_of_range) {
        const std::size_t exponent = word.find_first_of("eE");
        const bool is_small = (exponent != std::string_view::npos && word.substr(exponent + 1).starts_with('-')) ||
                              word.starts_with("0.") || word.starts_with("-0.") || word.starts_with('.');
        const T size = is_small ? T{0} : std::numeric_limits<T>::infinity();
        value = word.starts_with('-') ? -size : size;
    }
    return end == word.end() && error != std::errc::invalid_argument;
}

// Quotes a text for an error message, cut if it is long.
inline std::string excerpt(std::string_view text) {
    constexpr std::size_t longest = 40;
    return text.size() <= longest ? fmt::format("\"{}\"", text) : fmt::format("\"{}..\"", text.substr(0, longest));
}

}  // namespace pt
