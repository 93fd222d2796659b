// Finds the lines of a JSON text on which its members stand, which the library's values do not say, and the files that
// they name.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>

#include "harness/json_reader.h"

namespace pt {

// The lines, from 1, of the keys and of the objects in arrays of a text that is JSON, by their paths: "$.a[2].b".
std::map<std::string, std::size_t> lines_of_json(const std::string& text);

// Throws InputError with the scene's line and place where a file that the scene's text names is no file, or none that
// can be read, and reading it has failed so.
void check_named_file(const JsonValue& value, const InputError& failure);

// What `read(path)` makes of the file that the text names, from the scene's folder. An importer may hold files that are
// not on the disk yet, so whether there is one is asked where reading has failed for that.
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
