// The list of formats that `ptbench import` reads, and the detection of a file's format.
#pragma once

#include <string>
#include <vector>

#include "harness/interchange/import_result.h"

namespace pt {

struct ImportFormat {
    const char* name;
    std::vector<std::string> endings;          // file extensions of the format in lower case, with dots
    bool (*is_like)(const std::string& text);  // whether a text begins like the format, for files of unknown extension
    ImportResult (*import)(const ImportSource& source);
    std::size_t largest = largest_import;  // size limit of a source file in bytes
};

const std::vector<ImportFormat>& import_formats();

// Detects the format of a source: by file extension, else the first format whose `is_like` accepts the text. The last
// format accepts any text.
const ImportFormat& import_format_of(const ImportSource& source);

// Reads a source file of an import: text, or the bytes of binary glTF. The extension decides how large it may be.
std::string read_import(const std::string& file);

ImportResult import_scene(const ImportSource& source);

}  // namespace pt
