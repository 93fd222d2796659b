// Scenes in the CIS 565 text format.
#include "harness/interchange/import_cis565.h"

#include "tests/fuzz/imports.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    pt::fuzz::require_import(pt::import_cis565(pt::fuzz::source_of(data, size, "scene.txt")));
    return 0;
}
