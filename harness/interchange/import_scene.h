// The formats that `ptbench import` reads, and which of them a file is in.
#pragma once

#include <string>
#include <vector>

#include "harness/interchange/import_result.h"

namespace pt {

struct ImportFormat {
    const char* name;
    std::vector<std::string> endings;          // of file names, in lower case, with their dots
    bool (*is_like)(const std::string& text);  // a look at the first bytes, for other endings
    ImportResult (*import)(const ImportSource& source);
    std::size_t largest = largest_import;  // bytes of a file with such an ending
};

const std::vector<ImportFormat>& import_formats();

// The format of a source by the file name's ending; where no format has that, the first that the text is like. Never
// null: the last is like any text.
const ImportFormat& import_format_of(const ImportSource& source);

// The text of a file, readable, or its bytes where it is binary glTF; how large it may be is by its name.
std::string read_import(const std::string& file);

ImportResult import_scene(const ImportSource& source);

}  // namespace pt
