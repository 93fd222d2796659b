// Small texts in the CIS 565 format, for tests of the importer.
#pragma once

#include <string>

#include <gtest/gtest.h>

#include "harness/interchange/import_cis565.h"

namespace pt::test {

inline const std::string plain_camera = R"(CAMERA
RES 40 30
FOVY 30
ITERATIONS 10
DEPTH 5
FILE plain
EYE 1 2 3
LOOKAT 1 2 0
UP 0 1 0
)";
inline const std::string plain_object = R"(OBJECT 0
cube
material 0
TRANS 0 0 0
ROTAT 0 0 0
SCALE 1 1 1
)";

// The scene of one material, given by its lines, on one cube.
inline std::string with_material(const std::string& lines) {
    return "MATERIAL 0\n" + lines + plain_camera + plain_object;
}

inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
    const std::size_t position = text.find(from);
    EXPECT_NE(position, std::string::npos) << from;
    return position == std::string::npos ? text : text.replace(position, from.size(), to);
}

// All problems of the text, a line each; empty: none.
inline std::string problems_of(const std::string& text, const std::string& name = "") {
    const ImportResult result = import_cis565_scene(text, "cis565.txt", name);
    EXPECT_EQ(result.json.empty(), result.problems.count() > 0);
    std::string lines;
    for (const std::string& message : result.problems.messages("cis565.txt", "")) {
        lines += message + "\n";
    }
    return lines;
}

}  // namespace pt::test
