#include "harness/text_file.h"

namespace pt {

namespace {

constexpr std::string_view utf8_mark("\xef\xbb\xbf");

// Names the encoding of a text that is not UTF-8; an empty name means that it may be UTF-8. The byte order marks of
// UTF-32 are tried first, since they begin with those of UTF-16.
std::string other_encoding_of(std::string_view content) {
    using namespace std::string_view_literals;
    constexpr std::pair<std::string_view, const char*> marks[] = {
        {"\xff\xfe\0\0"sv, "UTF-32"}, {"\0\0\xfe\xff"sv, "UTF-32"}, {"\xff\xfe"sv, "UTF-16"}, {"\xfe\xff"sv, "UTF-16"}};
    for (const auto& [mark, name] : marks) {
        if (content.starts_with(mark)) {
            return std::string("text in ") + name + ", by its byte order mark";
        }
    }
    return content.substr(0, 4).find('\0') == std::string_view::npos
               ? ""
               : "the byte 0 among the first four, as in UTF-16 and UTF-32";
}

}  // namespace

std::string_view without_byte_order_mark(std::string_view content, const std::string& file) {
    if (const std::string other = other_encoding_of(content); !other.empty()) {
        throw InputError(file, "line 1", other, "text in UTF-8: save the file as that");
    }
    return content.starts_with(utf8_mark) ? content.substr(utf8_mark.size()) : content;
}

std::string readable_text(std::string content, const std::string& file) {
    content.erase(0, content.size() - without_byte_order_mark(content, file).size());
    std::size_t kept = content.find('\r');
    if (kept == std::string::npos) {
        return content;
    }
    for (std::size_t at = kept; at < content.size(); ++at) {
        if (content[at] != '\r') {
            content[kept++] = content[at];
        } else if (at + 1 == content.size() || content[at + 1] != '\n') {
            content[kept++] = '\n';
        }
    }
    content.resize(kept);
    return content;
}

std::string read_text_file(const std::string& path, std::uint64_t largest) {
    return readable_text(read_file(path, largest), path);
}

}  // namespace pt
