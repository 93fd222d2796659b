// Reads JSON objects strictly: every key is asked for by name, and what was not asked for is an error. Used for scenes
// and suites alike. Errors name the file, the JSON path, what was found and what is allowed.
#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "harness/failure.h"

namespace pt {

using Json = nlohmann::json;

// Most bytes of a file that people write by hand (scenes, suites and texts to import, which are smaller by far) and of
// a result, which is what we write.
inline constexpr std::uint64_t largest_input = std::uint64_t{64} << 20;
inline constexpr std::uint64_t largest_result = std::uint64_t{1} << 30;

// The text of a regular file of at most `largest` bytes. Throws InputError that says which it is: missing, a folder, no
// regular file, no permission or too large.
std::string read_file(const std::string& path, std::uint64_t largest = largest_input);

// The ending of a file's name, with its dot and in lower case, which says which reader the file is for.
std::string ending_of(const std::filesystem::path& file);

// Parses strictly: no comments, no byte 0, no duplicate keys, no numbers beyond double, no more than 64 levels. `file`
// is for the messages.
Json parse_json(const std::string& text, const std::string& file);

// Takes a first look at a file that will be read strictly, and which that may refuse: its value, discarded where it is
// no JSON. array_in is the array at `key` of an object, and an empty one of anything else.
Json parse_loosely(const std::string& file);
const Json& array_in(const Json& value, const std::string& key);

// A short rendering of a value for "found ...".
std::string describe(const Json& value);

class JsonValue {
public:
    JsonValue(const Json& json, std::string file, std::string path)
        : json_(&json), file_(std::move(file)), path_(std::move(path)) {}

    const Json& json() const { return *json_; }
    const std::string& path() const { return path_; }
    const std::string& file() const { return file_; }

    // A finite number in [low, high]; `allowed` says so in words.
    double number(double low, double high, const std::string& allowed) const;
    // A whole number in [low, high], written without a fraction.
    long long whole(long long low, long long high, const std::string& allowed) const;
    bool boolean() const;
    std::string text() const;
    // The file that a text names: absolute, or from the folder of the file that the text stands in.
    std::filesystem::path named_file() const;
    // Text that can be part of a benchmark's or a file's name: 1 to 64 letters, digits, '_' and '-'.
    std::string plain_name() const;
    std::string one_of(const std::vector<std::string>& allowed) const;
    // The elements of an array.
    std::vector<JsonValue> elements() const;
    [[noreturn]] void fail(const std::string& allowed) const;

private:
    const Json* json_;
    std::string file_;
    std::string path_;
};

// Throws InputError if the last element stands twice in the list.
template <class T>
void check_once(const std::vector<T>& list, const std::string& file, const std::string& place) {
    if (std::count(list.begin(), list.end(), list.back()) > 1) {
        throw InputError(file, place, fmt::format("{} twice", Json(list.back()).dump()), "once");
    }
}

class JsonObject {
public:
    // Fails unless the value is an object whose keys are all among `keys`.
    JsonObject(const JsonValue& value, std::vector<std::string> keys);

    bool has(const std::string& key) const { return json_->contains(key); }
    // The member; fails if it is missing.
    JsonValue required(const std::string& key) const;
    // The member; call only if has(key).
    JsonValue at(const std::string& key) const;

private:
    const Json* json_;
    std::string file_;
    std::string path_;
};

}  // namespace pt
