// Scenes in the CIS 565 text format: what the importer accepts is a scene file, and all that it says is in lines.
#include "harness/scene/import_cis565.h"

#include "tests/fuzz/findings.h"

namespace {

void require_lines(const pt::ImportFindings& findings) {
    for (const std::string& message : findings.messages("cis565.txt", "")) {
        pt::fuzz::require(message.starts_with("cis565.txt:") && message == pt::one_line(message),
                          "a finding that is not one line: " + message);
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const pt::ImportResult result = pt::import_cis565_scene(pt::fuzz::text_of(data, size), "cis565.txt");
    require_lines(result.problems);
    require_lines(result.warnings);
    require_lines(result.notes);
    pt::fuzz::require(result.json.empty() == (result.problems.count() > 0), "a scene with problems, or none without");
    if (result.problems.count() > 0) {
        return 0;
    }
    try {
        (void)pt::parse_scene(result.json, "scene.json");
    } catch (const pt::InputError& error) {
        throw std::logic_error(std::string("imported, but no scene: ") + error.what());
    }
    return 0;
}
