#include "harness/interchange/import_scene.h"

#include <algorithm>

#include "harness/interchange/import_cis565.h"
#include "harness/interchange/import_course_json.h"
#include "harness/interchange/import_gltf.h"
#include "harness/interchange/import_mitsuba.h"
#include "harness/text_file.h"

namespace pt {

namespace {

bool is_any_text(const std::string&) { return true; }

// The import format with a file's extension; null if none has it.
const ImportFormat* format_by_ending(const std::string& file) {
    const std::vector<ImportFormat>& formats = import_formats();
    const std::string ending = ending_of(file);
    const auto named = std::find_if(formats.begin(), formats.end(), [&](const ImportFormat& format) {
        return std::find(format.endings.begin(), format.endings.end(), ending) != format.endings.end();
    });
    return named != formats.end() ? &*named : nullptr;
}

}  // namespace

// All import formats. A new format is added before the last, which accepts any text.
const std::vector<ImportFormat>& import_formats() {
    static const std::vector<ImportFormat> formats{
        {"CIS 565 JSON", {".json"}, is_like_json, import_course_json},
        {"glTF 2", {".gltf", ".glb"}, is_like_gltf, import_gltf, largest_gltf},
        {"Mitsuba 3 XML", {".xml"}, is_like_mitsuba, import_mitsuba},
        {"CIS 565 text", {".txt"}, is_any_text, import_cis565},
    };
    return formats;
}

std::string read_import(const std::string& file) {
    const ImportFormat* named = format_by_ending(file);
    std::string content = read_file(file, named != nullptr ? named->largest : largest_import);
    return is_like_gltf(content) ? content : readable_text(std::move(content), file);
}

const ImportFormat& import_format_of(const ImportSource& source) {
    const std::vector<ImportFormat>& formats = import_formats();
    if (const ImportFormat* named = format_by_ending(source.file)) {
        return *named;
    }
    return *std::find_if(formats.begin(), formats.end(),
                         [&](const ImportFormat& format) { return format.is_like(source.text); });
}

ImportResult import_scene(const ImportSource& source) { return import_format_of(source).import(source); }

}  // namespace pt
