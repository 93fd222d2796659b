// Texts as other programs save them: byte order marks, line ends and encodings, in every format that is read.
#include "harness/text_file.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "harness/bench/suite.h"
#include "harness/failure.h"
#include "harness/interchange/import_scene.h"
#include "harness/mesh/read_mesh.h"
#include "harness/scene/scene.h"
#include "tests/support/cis565_texts.h"
#include "tests/support/command.h"
#include "tests/support/places.h"

namespace pt {
namespace {

using namespace std::string_literals;

const std::string mark = "\xef\xbb\xbf";

// An ASCII text in UTF-16 or UTF-32: `bytes` for each character, the least one first or last.
std::string widened(const std::string& text, std::size_t bytes, bool least_first) {
    std::string wide;
    for (const char c : text) {
        std::string unit(bytes, '\0');
        unit[least_first ? 0 : bytes - 1] = c;
        wide += unit;
    }
    return wide;
}

std::string with_line_ends(const std::string& text, const std::string& end) {
    std::string changed;
    for (const char c : text) {
        changed += c == '\n' ? end : std::string(1, c);
    }
    return changed;
}

std::string fault_of(const std::string& content) {
    try {
        (void)readable_text(content, "a");
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

TEST(TextFile, MarksAreTakenOffAndLinesEndAlike) {
    EXPECT_EQ(readable_text(mark + "v 1\r\nv 2\rv 3\n\r\r\n", "a"), "v 1\nv 2\nv 3\n\n\n");
    EXPECT_EQ(readable_text("", "a"), "");
    EXPECT_EQ(readable_text(mark, "a"), "");
    EXPECT_EQ(readable_text("\r", "a"), "\n");
    EXPECT_EQ(readable_text("a" + mark, "a"), "a" + mark);
}

TEST(TextFile, OtherEncodingsAreRefusedByName) {
    const std::string save = ", allowed: text in UTF-8: save the file as that";
    for (const bool least_first : {true, false}) {
        const std::string mark16 = least_first ? "\xff\xfe" : "\xfe\xff";
        const std::string mark32 = least_first ? "\xff\xfe\0\0"s : "\0\0\xfe\xff"s;
        EXPECT_EQ(fault_of(mark16 + widened("v 1", 2, least_first)),
                  "a: line 1: found text in UTF-16, by its byte order mark" + save);
        EXPECT_EQ(fault_of(mark32 + widened("v 1", 4, least_first)),
                  "a: line 1: found text in UTF-32, by its byte order mark" + save);
        for (const std::size_t bytes : {2, 4}) {
            EXPECT_EQ(fault_of(widened("v 1", bytes, least_first)),
                      "a: line 1: found the byte 0 among the first four, as in UTF-16 and UTF-32" + save);
        }
    }
}

// A text in each of the formats, and what reads it from a file.
struct Format {
    std::string file, text;
    std::string (*read)(const std::string& file);  // all that it says of the file's content
};

std::string read_as_mesh(const std::string& file) {
    const Mesh mesh = read_mesh(file);
    return fmt::format("{} {} {}", content_hash(mesh), mesh.triangles.size(), mesh.warnings.messages().size());
}

std::string read_as_import(const std::string& file) {
    const ImportResult result =
        import_scene({.text = read_import(file), .file = file, .out = file + ".json", .name = "a"});
    EXPECT_EQ(result.problems.messages("", ""), std::vector<std::string>());
    return fmt::format("{} {}", result.json, result.warnings.count());
}

std::vector<Format> formats() {
    const auto read_as_scene = [](const std::string& file) { return load_scene(file).hash; };
    const auto read_as_suite = [](const std::string& file) { return load_suite(file).name; };
    const std::string course_json = R"({"Materials": {"m": {"TYPE": "Diffuse",
"RGB": [1, 1, 1]}},
"Camera": {"RES": [4, 3], "FOVY": 30, "DEPTH": 5, "EYE": [1, 2, 9], "LOOKAT": [1, 2, 0], "UP": [0, 1, 0]},
"Objects": [{"TYPE": "cube", "MATERIAL": "m"}]}
)";
    return {
        {"a.obj", "v 0 0 0\nv 2 0 0\nv 2 2 0\nf 1 2 3\n", read_as_mesh},
        {"a.ply",
         "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
         "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n2 0 0\n2 2 0\n3 0 1 2\n",
         read_as_mesh},
        {"a.txt", test::with_material("RGB 1 1 1\n\n"), read_as_import},
        {"a.course.json", course_json, read_as_import},
        {"a.xml", test::content_of(test::in_source("tests/fuzz/corpus/import_mitsuba/room.xml")), read_as_import},
        {"a.json", test::content_of(test::in_source("scenes/cornell_open.json")), read_as_scene},
        {"suite.json", test::content_of(test::in_source("scenes/suites/quick.json")), read_as_suite},
    };
}

TEST(TextFile, EveryFormatIsReadWhicheverProgramSavedIt) {
    const test::TemporaryFolder folder;
    for (const Format& format : formats()) {
        const std::string file = folder.file(format.file);
        test::write_text(file, format.text);
        const std::string expected = format.read(file);
        EXPECT_NE(expected, "");
        for (const std::string& end : {"\n"s, "\r\n"s, "\r"s}) {
            test::write_text(file, mark + with_line_ends(format.text, end));
            EXPECT_EQ(format.read(file), expected) << format.file << " " << end.size() << " " << int{end[0]};
        }
        test::write_text(file, "\xff\xfe" + widened(format.text, 2, true));
        try {
            (void)format.read(file);
            ADD_FAILURE() << format.file;
        } catch (const InputError& error) {
            EXPECT_NE(std::string(error.what()).find("line 1: found text in UTF-16"), std::string::npos)
                << error.what();
        }
    }
}

// A binary file begins behind its header's last line end, even where the next number begins with the byte of an LF.
TEST(TextFile, ThePlyHeaderMayHaveMarksAndCrBeforeBinaryNumbers) {
    const std::string header =
        "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty uchar x\nproperty uchar y\nproperty uchar z\n"
        "element face 1\nproperty list uchar uchar vertex_indices\nend_header\n";
    const std::string numbers = "\x0a\0\0\0\x0a\0\0\0\x0a\x03\0\x01\x02"s;
    for (const std::string& end : {"\n"s, "\r\n"s, "\r"s}) {
        const Mesh mesh = parse_ply(mark + with_line_ends(header, end) + numbers, "a");
        EXPECT_EQ(mesh.vertices, (std::vector<std::array<float, 3>>{{10, 0, 0}, {0, 10, 0}, {0, 0, 10}}));
    }
}

}  // namespace
}  // namespace pt
