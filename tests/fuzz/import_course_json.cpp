// Scenes in the JSON format of CIS 565.
#include "harness/interchange/import_course_json.h"

#include "tests/fuzz/imports.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    pt::fuzz::require_import(pt::import_course_json(pt::fuzz::source_of(data, size, "scene.json")));
    return 0;
}
