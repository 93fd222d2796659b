#include "harness/scene/json_lines.h"

#include <string_view>
#include <system_error>
#include <vector>

#include <fmt/format.h>
#include <unistd.h>

namespace pt {

namespace {

class LineFinder {
public:
    explicit LineFinder(const std::string& text) : text_(&text) {}

    std::map<std::string, std::size_t> lines();

private:
    struct Level {
        std::string path;
        bool is_object = false, has_key = false;
        std::string key = "";
        std::size_t index = 0;
    };

    std::string place() const;
    void read_string();
    void open(bool is_object);
    void next();

    const std::string* text_;
    std::size_t at_ = 0, line_ = 1;
    std::vector<Level> levels_;
    std::map<std::string, std::size_t> lines_;
};

// JSON path, such as "$.objects[3]", of the value that the parser reads next.
std::string LineFinder::place() const {
    if (levels_.empty()) {
        return "$";
    }
    const Level& level = levels_.back();
    return level.is_object ? level.path + "." + level.key : fmt::format("{}[{}]", level.path, level.index);
}

// Skips a JSON string up to its closing quotation mark. Where a key is due, the string becomes the current key.
void LineFinder::read_string() {
    const std::size_t start = at_;
    for (++at_; (*text_)[at_] != '"'; ++at_) {
        at_ += (*text_)[at_] == '\\' ? 1 : 0;
    }
    if (!levels_.empty() && levels_.back().is_object && !levels_.back().has_key) {
        levels_.back().key = Json::parse(text_->substr(start, at_ - start + 1)).get<std::string>();
        levels_.back().has_key = true;
        lines_.emplace(place(), line_);
    }
}

void LineFinder::open(bool is_object) {
    const std::string path = place();
    if (is_object) {
        lines_.emplace(path, line_);
    }
    levels_.push_back({.path = path, .is_object = is_object});
}

void LineFinder::next() {
    switch ((*text_)[at_]) {
        case '\n':
            line_ += 1;
            break;
        case '"':
            read_string();
            break;
        case '{':
        case '[':
            open((*text_)[at_] == '{');
            break;
        case '}':
        case ']':
            levels_.pop_back();
            break;
        case ',':
            levels_.back().has_key = false;
            levels_.back().index += 1;
            break;
        default:
            break;
    }
}

std::map<std::string, std::size_t> LineFinder::lines() {
    for (; at_ < text_->size(); ++at_) {
        next();
    }
    return lines_;
}

}  // namespace

std::map<std::string, std::size_t> lines_of_json(const std::string& text) { return LineFinder(text).lines(); }

namespace {

// Place of a JSON value for error messages: "scene.json:12", or the scene's name if its text does not come from a file.
std::string place_of(const JsonValue& value) {
    try {
        const std::map<std::string, std::size_t> lines = lines_of_json(read_file(value.file()));
        const auto line = lines.find(value.path());
        return line == lines.end() ? value.file() : fmt::format("{}:{}", value.file(), line->second);
    } catch (const InputError&) {
        return value.file();
    }
}

std::string why_not_readable(const std::filesystem::path& file) {
    std::error_code failed;
    const std::filesystem::file_status status = std::filesystem::status(file, failed);
    if (!std::filesystem::exists(status)) {
        return "which is no file";
    }
    if (std::filesystem::is_directory(status)) {
        return "which is a folder";
    }
    return ::access(file.c_str(), R_OK) == 0 ? "" : "which may not be read";
}

}  // namespace

void check_named_file(const JsonValue& value, const InputError& failure) {
    if (std::string_view(failure.what()).find(": the file: found ") == std::string_view::npos) {
        return;  // the file that the scene names could be opened, so its content is at fault
    }
    const std::filesystem::path file = value.named_file();
    if (const std::string reason = why_not_readable(file); !reason.empty()) {
        throw InputError(place_of(value), value.path(),
                         fmt::format("{}, {} ({})", describe(value.json()), reason, file.string()),
                         "a file, by its path from the scene's folder");
    }
}

}  // namespace pt
