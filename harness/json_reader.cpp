#include "harness/json_reader.h"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "harness/files_read.h"
#include "harness/nearest_name.h"
#include "harness/words.h"

namespace pt {

namespace {

[[noreturn]] void cannot_read(const std::string& path, const std::string& found, std::uint64_t largest) {
    throw InputError(path, "the file", found,
                     fmt::format("a regular file of at most {} MiB that can be read", largest >> 20));
}

std::string in_words(int reason) {
    switch (reason) {
        case ENOENT:
            return "no such file";
        case ENOTDIR:
            return "a path through a file that is no folder";
        case EACCES:
            return "no permission to read it";
        default:
            return std::strerror(reason);
    }
}

void check_kind(const struct stat& status, const std::string& path, std::uint64_t largest) {
    if (S_ISDIR(status.st_mode)) {
        cannot_read(path, "a folder", largest);
    }
    if (!S_ISREG(status.st_mode)) {
        cannot_read(path, "no regular file (a device, a pipe or a socket)", largest);
    }
    if (static_cast<std::uint64_t>(status.st_size) > largest) {
        cannot_read(path, fmt::format("{} bytes, too large", status.st_size), largest);
    }
}

// An open file, closed by its destructor.
class OpenFile {
public:
    // Opens the file with O_NONBLOCK: a pipe that has taken the file's name since its kind was checked must not block.
    explicit OpenFile(const std::string& path) : descriptor_(::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC)) {}
    ~OpenFile() {
        if (descriptor_ >= 0) {
            ::close(descriptor_);
        }
    }
    OpenFile(const OpenFile&) = delete;
    OpenFile& operator=(const OpenFile&) = delete;

    int descriptor() const { return descriptor_; }

private:
    int descriptor_;
};

// Reads a whole regular file and sets `status` to what fstat tells of it. Throws InputError.
std::string read_whole(const std::string& path, std::uint64_t largest, struct stat& status) {
    if (::stat(path.c_str(), &status) != 0) {
        cannot_read(path, in_words(errno), largest);
    }
    check_kind(status, path, largest);  // checked before open(), since opening a device file may affect the device
    const OpenFile file(path);
    if (file.descriptor() < 0 || ::fstat(file.descriptor(), &status) != 0) {
        cannot_read(path, in_words(errno), largest);
    }
    check_kind(status, path, largest);
    std::string text;
    for (std::size_t done = 0;;) {
        // The first read asks for one byte more than the file's size, to see its end; a growing file needs more reads.
        text.resize(done == 0 ? static_cast<std::size_t>(status.st_size) + 1 : done + (1 << 16));
        const ssize_t got = ::read(file.descriptor(), text.data() + done, text.size() - done);
        if (got < 0 && errno != EINTR) {
            cannot_read(path, in_words(errno), largest);
        }
        done += static_cast<std::size_t>(std::max<ssize_t>(got, 0));
        if (done > largest) {
            cannot_read(path, "more bytes than when it was opened, too large", largest);
        }
        if (got == 0) {
            text.resize(done);
            return text;
        }
    }
}

}  // namespace

std::string read_file(const std::string& path, std::uint64_t largest) {
    struct stat status {};
    std::string text = read_whole(path, largest, status);
    note_read(status);
    return text;
}

std::string read_earlier_output(const std::string& file, std::uint64_t largest) {
    struct stat status {};
    return read_whole(file, largest, status);
}

namespace {

// Limit on the nesting of JSON. The files of ptbench nest less than half as deep, and code that copies or prints JSON
// recurses once for each level.
constexpr std::size_t deepest_nesting = 64;

// The error for text that is not JSON: the library's message without its "[json.exception.parse_error.101]".
InputError not_json(const std::string& file, const Json::exception& error) {
    std::string message = error.what();
    if (const auto bracket = message.find("] "); bracket != std::string::npos) {
        message = message.substr(bracket + 2);
    }
    std::replace(message.begin(), message.end(), '\n', ' ');
    return InputError(fmt::format("{}: not valid JSON: {}", file, message));
}

// Checks a JSON text without keeping its values. Throws InputError for text that is not JSON, for a key that occurs
// twice in an object, and for containers nested too deeply. A SAX parser does this in linear time: nlohmann's parser
// callbacks look at all elements of an array again after each element.
class Checker final : public nlohmann::json_sax<Json> {
public:
    explicit Checker(std::string file) : file_(std::move(file)) {}

    bool null() override { return advance(); }
    bool boolean(bool) override { return advance(); }
    bool number_integer(number_integer_t) override { return advance(); }
    bool number_unsigned(number_unsigned_t) override { return advance(); }
    bool number_float(number_float_t, const string_t&) override { return advance(); }
    bool string(string_t&) override { return advance(); }
    bool binary(binary_t&) override { return advance(); }
    bool start_object(std::size_t) override { return open(false); }
    bool end_object() override { return close(); }
    bool start_array(std::size_t) override { return open(true); }
    bool end_array() override { return close(); }
    bool key(string_t& name) override {
        open_.back().key = name;
        if (!open_.back().keys.insert(name).second) {
            throw InputError(file_, innermost_path(), fmt::format("the key \"{}\" twice", name), "once");
        }
        return true;
    }
    bool parse_error(std::size_t, const std::string&, const Json::exception& error) override {
        throw not_json(file_, error);
    }

private:
    struct Container {
        bool is_array = false;
        std::size_t index = 0;            // in a JSON array: index of the element being read
        std::string key = {};             // in a JSON object: key of the member being read
        std::set<std::string> keys = {};  // in a JSON object: keys met so far
    };

    // The JSON path of the innermost value, built only when an error needs it.
    std::string innermost_path() const {
        std::string path = "$";
        for (auto container = open_.begin(); container + 1 != open_.end(); ++container) {
            path += container->is_array ? fmt::format("[{}]", container->index) : "." + container->key;
        }
        return path;
    }
    bool open(bool is_array) {
        if (open_.size() == deepest_nesting) {
            throw InputError(file_, innermost_path(), "arrays and objects within each other",
                             fmt::format("{} levels of them", deepest_nesting));
        }
        open_.push_back({.is_array = is_array});
        return true;
    }
    bool close() {
        open_.pop_back();
        return advance();
    }
    bool advance() {
        if (!open_.empty()) {
            open_.back().index += 1;
        }
        return true;
    }

    std::string file_;
    std::vector<Container> open_;
};

}  // namespace

std::string ending_of(const std::filesystem::path& file) { return in_lower_case(file.extension().string()); }

Json parse_json(const std::string& text, const std::string& file) {
    // The byte 0 is refused, since nlohmann's parser takes it for the end of the text and ignores what follows.
    if (const std::size_t zero = text.find('\0'); zero != std::string::npos) {
        const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(zero), '\n');
        throw InputError(file, fmt::format("line {}", line), "the byte 0", "text without it");
    }
    Checker checker(file);
    Json::sax_parse(text, &checker);
    try {
        return Json::parse(text);
    } catch (const Json::exception& error) {
        throw not_json(file, error);
    }
}

Json parse_loosely(const std::string& file) {
    std::ifstream stream(file);
    return Json::parse(stream, nullptr, false);
}

const Json& array_in(const Json& value, const std::string& key) {
    static const Json none = Json::array();
    const auto found = value.find(key);  // find() returns end() if the value is no object
    return found != value.end() && found->is_array() ? *found : none;
}

std::string describe(const Json& value) {
    switch (value.type()) {
        case Json::value_t::object:
            return "an object";
        case Json::value_t::array:
            if (value.size() > 4 ||
                std::any_of(value.begin(), value.end(), [](const Json& v) { return v.is_structured(); })) {
                return fmt::format("an array of {}", value.size());
            }
            [[fallthrough]];
        default: {
            std::string text = value.dump(-1, ' ', false, Json::error_handler_t::replace);
            return text.size() > 60 ? text.substr(0, 57) + "..." : text;
        }
    }
}

void JsonValue::fail(const std::string& allowed) const { throw InputError(file_, path_, describe(*json_), allowed); }

double JsonValue::number(double low, double high, const std::string& allowed) const {
    if (!json_->is_number()) {
        fail(allowed);
    }
    const double value = json_->get<double>();
    if (!std::isfinite(value) || value < low || value > high) {
        fail(allowed);
    }
    return value;
}

long long JsonValue::whole(long long low, long long high, const std::string& allowed) const {
    if (!json_->is_number_integer() ||
        (json_->is_number_unsigned() && json_->get<std::uint64_t>() > static_cast<std::uint64_t>(INT64_MAX))) {
        fail(allowed);
    }
    const long long value = json_->get<long long>();
    if (value < low || value > high) {
        fail(allowed);
    }
    return value;
}

bool JsonValue::boolean() const {
    if (!json_->is_boolean()) {
        fail("true or false");
    }
    return json_->get<bool>();
}

std::string JsonValue::text() const {
    if (!json_->is_string()) {
        fail("a string");
    }
    return json_->get<std::string>();
}

std::filesystem::path JsonValue::named_file() const { return std::filesystem::path(file_).parent_path() / text(); }

std::string JsonValue::plain_name() const {
    const std::string name = text();
    const bool plain = !name.empty() && name.size() <= 64 && std::all_of(name.begin(), name.end(), [](unsigned char c) {
        return std::isalnum(c) != 0 || c == '_' || c == '-';
    });
    if (!plain) {
        fail("1 to 64 letters, digits, '_' and '-' (it becomes part of benchmark names)");
    }
    return name;
}

std::string JsonValue::one_of(const std::vector<std::string>& allowed) const {
    const bool known =
        json_->is_string() && std::find(allowed.begin(), allowed.end(), json_->get<std::string>()) != allowed.end();
    if (!known) {
        fail(fmt::format("\"{}\"{}", fmt::join(allowed, "\", \""),
                         json_->is_string() ? did_you_mean(json_->get<std::string>(), allowed) : ""));
    }
    return json_->get<std::string>();
}

std::vector<JsonValue> JsonValue::elements() const {
    if (!json_->is_array()) {
        fail("an array");
    }
    std::vector<JsonValue> values;
    for (std::size_t i = 0; i < json_->size(); ++i) {
        values.emplace_back((*json_)[i], file_, fmt::format("{}[{}]", path_, i));
    }
    return values;
}

JsonObject::JsonObject(const JsonValue& value, std::vector<std::string> keys)
    : json_(&value.json()), file_(value.file()), path_(value.path()) {
    if (!json_->is_object()) {
        value.fail("an object");
    }
    for (const auto& [key, member] : json_->items()) {
        if (std::find(keys.begin(), keys.end(), key) == keys.end()) {
            throw InputError(file_, path_, fmt::format("unknown key \"{}\"", key),
                             fmt::format("{}{}", fmt::join(keys, ", "), did_you_mean(key, keys)));
        }
    }
}

JsonValue JsonObject::required(const std::string& key) const {
    if (!json_->contains(key)) {
        throw InputError(file_, path_, "no key \"" + key + "\"", "it is required");
    }
    return at(key);
}

JsonValue JsonObject::at(const std::string& key) const { return {json_->at(key), file_, path_ + "." + key}; }

}  // namespace pt
