#include "harness/failure.h"

#include <cstddef>
#include <string_view>

namespace pt {

namespace {

// Length in bytes of the well-formed UTF-8 character (Unicode 15, table 3-7) at the start of `text`, or 0 if none is.
std::size_t utf8_length(std::string_view text) {
    const auto byte = [&](std::size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u; };
    const auto continues = [&](std::size_t i) { return byte(i) >= 0x80 && byte(i) <= 0xbf; };
    const unsigned first = byte(0);
    const unsigned second = byte(1);
    if (first < 0x80) {
        return 1;
    }
    if (first >= 0xc2 && first <= 0xdf) {
        return continues(1) ? 2 : 0;
    }
    if (first >= 0xe0 && first <= 0xef) {
        const bool is_overlong = first == 0xe0 && second < 0xa0;
        const bool is_surrogate = first == 0xed && second > 0x9f;
        return continues(1) && continues(2) && !is_overlong && !is_surrogate ? 3 : 0;
    }
    if (first >= 0xf0 && first <= 0xf4) {
        const bool is_overlong = first == 0xf0 && second < 0x90;
        const bool is_beyond = first == 0xf4 && second > 0x8f;
        return continues(1) && continues(2) && continues(3) && !is_overlong && !is_beyond ? 4 : 0;
    }
    return 0;
}

// Whether a character is a control character (C0, DEL or C1, U+0080 to U+009F) or the invisible byte order mark.
bool is_control(std::string_view character) {
    const auto first = static_cast<unsigned char>(character[0]);
    const bool is_c1 = character.size() == 2 && first == 0xc2 && static_cast<unsigned char>(character[1]) < 0xa0;
    return first < 0x20 || first == 0x7f || is_c1 || character == "\xef\xbb\xbf";
}

}  // namespace

std::string one_line(const std::string& text) {
    static constexpr char digits[] = "0123456789abcdef";
    std::string line;
    for (std::size_t i = 0; i < text.size();) {
        const std::size_t length = utf8_length(std::string_view(text).substr(i));
        const std::string_view character = std::string_view(text).substr(i, length == 0 ? 1 : length);
        if (length != 0 && !is_control(character)) {
            line += character;
        } else {
            for (const char byte : character) {
                const auto value = static_cast<unsigned char>(byte);
                line += {'\\', 'x', digits[value / 16], digits[value % 16]};
            }
        }
        i += character.size();
    }
    return line;
}

}  // namespace pt
