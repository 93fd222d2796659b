// Finds the line numbers of members of a JSON text, which the JSON library does not record, and reports files that a
// scene names but that cannot be read.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>

#include "harness/json_reader.h"

namespace pt {

// Line numbers, from 1, of every key and of every object in an array of a valid JSON text, by JSON path: "$.a[2].b".
std::map<std::string, std::size_t> lines_of_json(const std::string& text);

// Called when reading a file that a scene names has failed with `failure`. If the file does not exist or is not
// readable, throws an InputError that gives the line and the JSON path in the scene file.
void check_named_file(const JsonValue& value, const InputError& failure);

// Returns `read(path)` of the file that a JSON text names relative to the scene's folder. Whether the file exists is
// checked only after `read` has failed, since an importer may hold files that are not on the disk yet.
template <class Read>
auto read_named_file(const JsonValue& value, const Read& read) {
    try {
        return read(value.named_file());
    } catch (const InputError& failure) {
        check_named_file(value, failure);
        throw;
    }
}

}  // namespace pt
