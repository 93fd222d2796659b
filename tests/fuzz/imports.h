// What every importer keeps to: what it accepts is a scene file, and all that it says is in lines.
#pragma once

#include "harness/interchange/import_result.h"
#include "harness/scene/scene.h"
#include "tests/fuzz/findings.h"

namespace pt::fuzz {

inline void require_lines(const ImportFindings& findings) {
    for (const std::string& message : findings.messages("scene", "")) {
        require(message.starts_with("scene:") && message == one_line(message),
                "a finding that is not one line: " + message);
    }
}

inline void require_import(const ImportResult& result) {
    require_lines(result.problems);
    require_lines(result.warnings);
    require_lines(result.notes);
    require(result.json.empty() == (result.problems.count() > 0), "a scene with problems, or none without");
    if (result.problems.count() > 0) {
        return;
    }
    try {
        (void)parse_scene(result.json, "scene.json");
    } catch (const InputError& error) {
        throw std::logic_error(std::string("imported, but no scene: ") + error.what());
    }
}

// In a folder that is not there, so that no file is looked for.
inline ImportSource source_of(const std::uint8_t* data, std::size_t size, const std::string& file) {
    return {.text = text_of(data, size), .file = "/nowhere/" + file, .out = "", .name = ""};
}

}  // namespace pt::fuzz
