// Where in a JSON text its members stand, which the library's values do not say, and the files that they name.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>

#include "harness/json_reader.h"

namespace pt {

// The lines, from 1, of the keys and of the objects in arrays of a text that is JSON, by their paths: "$.a[2].b".
std::map<std::string, std::size_t> lines_of_json(const std::string& text);

// The file that a text of a scene names, from the scene's folder. Throws InputError with the scene's line and place
// where there is none that can be read.
std::filesystem::path readable_file_named_by(const JsonValue& value);

}  // namespace pt
