// Where in a JSON text its members stand: the library's values do not say.
#pragma once

#include <cstddef>
#include <map>
#include <string>

namespace pt {

// The lines, from 1, of the keys and of the objects in arrays of a text that is JSON, by their paths: "$.a[2].b".
std::map<std::string, std::size_t> lines_of_json(const std::string& text);

}  // namespace pt
