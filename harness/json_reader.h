// Reads JSON objects strictly: every key is asked for by name, and an unknown key is an error. Scenes and suites are
// read in this way. Errors name the file, the JSON path, what was found and what is allowed.
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

// Size limits in bytes: of input files, which people write by hand (scenes, suites, texts to import; all far smaller),
// and of results, which ptbench writes.
inline constexpr std::uint64_t largest_input = std::uint64_t{64} << 20;
inline constexpr std::uint64_t largest_result = std::uint64_t{1} << 30;

// Reads a regular file of at most `largest` bytes. Throws InputError, which says why the file cannot be read: missing,
// a folder, no regular file, no permission or too large.
std::string read_file(const std::string& path, std::uint64_t largest = largest_input);

// Returns a file's extension with its dot and in lower case, by which a reader for the file is chosen.
std::string ending_of(const std::filesystem::path& file);

// Parses JSON strictly: no comments, no byte 0, no duplicate keys, no numbers beyond double, no more than 64 levels.
// Error messages name `file`.
Json parse_json(const std::string& text, const std::string& file);

// `parse_loosely` parses JSON without the strict checks, for a first look at a file; its value is `discarded` if the
// file is no JSON. `array_in` returns the array at `key` of an object, and an empty array for any other value.
Json parse_loosely(const std::string& file);
const Json& array_in(const Json& value, const std::string& key);

// Returns a short text of a JSON value, for the "found ..." of an error message.
std::string describe(const Json& value);

class JsonValue {
public:
    JsonValue(const Json& json, std::string file, std::string path)
        : json_(&json), file_(std::move(file)), path_(std::move(path)) {}

    const Json& json() const { return *json_; }
    const std::string& path() const { return path_; }
    const std::string& file() const { return file_; }

    // Returns a finite number in [low, high]; otherwise throws InputError that says `allowed`.
    double number(double low, double high, const std::string& allowed) const;
    // Returns a whole number in [low, high], written without a fraction; otherwise throws InputError that says
    // `allowed`.
    long long whole(long long low, long long high, const std::string& allowed) const;
    bool boolean() const;
    std::string text() const;
    // The file that a JSON string names: an absolute path, or one relative to the folder of the JSON file.
    std::filesystem::path named_file() const;
    // A string that can be part of the name of a benchmark or a file: 1 to 64 letters, digits, '_' and '-'.
    std::string plain_name() const;
    std::string one_of(const std::vector<std::string>& allowed) const;
    std::vector<JsonValue> elements() const;
    [[noreturn]] void fail(const std::string& allowed) const;

private:
    const Json* json_;
    std::string file_;
    std::string path_;
};

// Throws InputError if the last element of the list occurs earlier in the list too.
template <class T>
void check_once(const std::vector<T>& list, const std::string& file, const std::string& place) {
    if (std::count(list.begin(), list.end(), list.back()) > 1) {
        throw InputError(file, place, fmt::format("{} twice", Json(list.back()).dump()), "once");
    }
}

class JsonObject {
public:
    // Throws InputError unless the value is an object whose keys are all among `keys`.
    JsonObject(const JsonValue& value, std::vector<std::string> keys);

    bool has(const std::string& key) const { return json_->contains(key); }
    // Returns the member with this key. Throws InputError if the object has no such key.
    JsonValue required(const std::string& key) const;
    // The member of a JSON object at a key for which has(key) is true.
    JsonValue at(const std::string& key) const;

private:
    const Json* json_;
    std::string file_;
    std::string path_;
};

}  // namespace pt
