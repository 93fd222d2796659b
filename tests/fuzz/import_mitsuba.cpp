// Scenes in Mitsuba's XML.
#include "harness/interchange/import_mitsuba.h"

#include "tests/fuzz/imports.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const pt::ImportSource source = pt::fuzz::source_of(data, size, "scene.xml");
    if (source.text.find("filename") == std::string::npos) {  // may be any file on this machine
        pt::fuzz::require_import(pt::import_mitsuba(source));
    }
    return 0;
}
