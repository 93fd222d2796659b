#include "harness/json_reader.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <fstream>
#include <sstream>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace pt {

std::string read_file(const std::string& path) {
    std::ifstream stream(path, std::ios::binary);
    std::ostringstream text;
    if (!stream || !(text << stream.rdbuf())) {
        throw InputError(fmt::format("{}: cannot be read (no such file, a directory, empty or no permission)", path));
    }
    return text.str();
}

namespace {

// Follows the parser's events, so that a duplicate key can be reported with its place.
class DuplicateKeys {
public:
    explicit DuplicateKeys(std::string file) : file_(std::move(file)) {}

    // Throws InputError at a key that its object has already.
    void follow(Json::parse_event_t event, const Json& parsed) {
        switch (event) {
            case Json::parse_event_t::object_start:
            case Json::parse_event_t::array_start:
                open_.push_back({.is_array = event == Json::parse_event_t::array_start});
                break;
            case Json::parse_event_t::object_end:
            case Json::parse_event_t::array_end:
                open_.pop_back();
                advance();
                break;
            case Json::parse_event_t::key:
                open_.back().key = parsed.get<std::string>();
                if (!open_.back().keys.insert(open_.back().key).second) {
                    throw InputError(file_, innermost_path(), fmt::format("the key \"{}\" twice", open_.back().key),
                                     "once");
                }
                break;
            default:
                advance();
        }
    }

private:
    struct Container {
        bool is_array = false;
        std::size_t index = 0;            // of the element being read
        std::string key = {};             // of the member being read
        std::set<std::string> keys = {};  // met so far
    };

    // Put together only when asked for: files may nest deeply.
    std::string innermost_path() const {
        std::string path = "$";
        for (auto container = open_.begin(); container + 1 != open_.end(); ++container) {
            path += container->is_array ? fmt::format("[{}]", container->index) : "." + container->key;
        }
        return path;
    }
    void advance() {
        if (!open_.empty()) {
            open_.back().index += 1;
        }
    }

    std::string file_;
    std::vector<Container> open_;
};

}  // namespace

Json parse_json(const std::string& text, const std::string& file) {
    DuplicateKeys duplicates(file);
    const auto follow = [&](int, Json::parse_event_t event, Json& parsed) {
        duplicates.follow(event, parsed);
        return true;
    };
    try {
        return Json::parse(text, follow);
    } catch (const Json::exception& error) {
        std::string message = error.what();  // "[json.exception.parse_error.101] parse error at line 1, column 2: ..."
        if (const auto bracket = message.find("] "); bracket != std::string::npos) {
            message = message.substr(bracket + 2);
        }
        std::replace(message.begin(), message.end(), '\n', ' ');
        throw InputError(fmt::format("{}: not valid JSON: {}", file, message));
    }
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
        fail(fmt::format("\"{}\"", fmt::join(allowed, "\", \"")));
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
                             fmt::format("{}", fmt::join(keys, ", ")));
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
