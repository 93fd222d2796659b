// Mesh files: what is read of good ones, and the one line that each fault of a broken one gets.
#include "harness/mesh/read_mesh.h"

#include <gtest/gtest.h>

#include "harness/error.h"
#include "tests/support/command.h"

namespace pt {
namespace {

// What reading it throws; empty where it is read.
template <class Parse>
std::string fault_of(const Parse& parse, const std::string& content) {
    try {
        (void)parse(content, "mesh");
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

std::string replaced(std::string text, const std::string& old, const std::string& with) {
    return text.replace(text.find(old), old.size(), with);
}

const std::string ascii_ply =
    "ply\nformat ascii 1.0\ncomment by hand\nelement vertex 4\nproperty float x\nproperty double y\nproperty float z\n"
    "property uchar red\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n"
    "0 0 0 255\n1 0 0 255\n1 1 0 255\n0 1 .5 255\n4 0 1 2 3\n3 0 0 2\n";

TEST(PlyTest, TextIsReadPolygonsAreFannedAndDegenerateFacesCounted) {
    const Mesh mesh = parse_ply(ascii_ply, "mesh");
    EXPECT_EQ(mesh.vertices, (std::vector<std::array<float, 3>>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0.5f}}));
    EXPECT_EQ(mesh.triangles, (std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}, {0, 2, 3}}));
    EXPECT_TRUE(mesh.normals.empty());
    EXPECT_EQ(mesh.degenerate_left_out, 1u);
}

TEST(PlyTest, BothByteOrdersAndNormalsAreRead) {
    const std::string header =
        "element vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty float nx\nproperty float ny\n"
        "property float nz\nelement face 1\nproperty list uchar uint vertex_index\nend_header\n";
    const auto file = [&](bool little) {
        std::string content =
            std::string("ply\r\nformat binary_") + (little ? "little" : "big") + "_endian 1.0\r\n" + header;
        const auto add = [&](std::uint32_t word) {
            for (int i = 0; i < 4; ++i) {
                content += static_cast<char>(word >> (little ? 8 * i : 24 - 8 * i));
            }
        };
        for (const std::uint32_t vertex : {0u, 1u, 2u}) {
            for (std::uint32_t i = 0; i < 6; ++i) {
                add(i == vertex || i == 5 ? 0x3fa00000u : 0u);  // 1.25
            }
        }
        content += '\3';
        add(0), add(1), add(2);
        return content;
    };
    for (const bool little : {true, false}) {
        const Mesh mesh = parse_ply(file(little), "mesh");
        EXPECT_EQ(mesh.vertices, (std::vector<std::array<float, 3>>{{1.25f, 0, 0}, {0, 1.25f, 0}, {0, 0, 1.25f}}));
        EXPECT_EQ(mesh.normals, (std::vector<std::array<float, 3>>(3, {0, 0, 1.25f})));
        EXPECT_EQ(mesh.triangles, (std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}}));
        EXPECT_EQ(fault_of(parse_ply, file(little).substr(0, file(little).size() - 1)),
                  "mesh: face 0: found the end of the file, allowed: all elements that the header declares");
    }
}

TEST(PlyTest, EachFaultHasItsLine) {
    const auto fault = [](const std::string& old, const std::string& with) {
        return fault_of(parse_ply, replaced(ascii_ply, old, with));
    };
    EXPECT_EQ(fault("4 0 1 2 3", "4 0 1 2 4"), "mesh: triangle 1: found vertex 4, allowed: 0 to 3");
    EXPECT_EQ(fault("4 0 1 2 3", "4 0 1 2 -1"),
              "mesh: face 0: found vertex -1, allowed: the number of a vertex, from 0");
    EXPECT_EQ(fault("4 0 1 2 3", "2 0 1"), "mesh: face 0: found 2 corners, allowed: at least 3");
    EXPECT_EQ(fault("1 1 0 255", "1 nan 0 255"),
              "mesh: vertex 2: found (1, nan, 0), allowed: finite numbers in single precision");
    EXPECT_EQ(fault("1 1 0 255", "1 1e39 0 255"),
              "mesh: vertex 2: found (1, inf, 0), allowed: finite numbers in single precision");
    EXPECT_EQ(fault("1 1 0 255", "1 1e-999 0 255"), "");
    EXPECT_EQ(fault("1 1 0 255", "1 x1 0 255"), "mesh: vertex 2: found \"x1\", allowed: a number");
    EXPECT_EQ(fault("3 0 0 2", "3 0 0"),
              "mesh: face 1: found the end of the file, allowed: all elements that the header declares");
    EXPECT_EQ(
        fault("4 0 1 2 3\n3 0 0 2", "3 0 0 3\n3 0 0 2"),
        "mesh: mesh: found 2 triangles without area and no other, allowed: at least one triangle that has an area");
    EXPECT_EQ(
        fault("vertex 4", "vertex 400000000"),
        "mesh: vertex 0: found 400000000 of them declared, and bytes for 7, allowed: a file as long as its header "
        "says");
    EXPECT_EQ(fault("property float z\n", ""), "mesh: header: found vertices without z, allowed: x, y and z");
    EXPECT_EQ(fault("vertex_indices", "corners"),
              "mesh: header: found faces without vertex_indices, allowed: a list of that name, or vertex_index");
    EXPECT_EQ(
        fault("ascii 1.0", "ascii 2.0"),
        "mesh: line 2: found format ascii 2.0, allowed: once: ascii, binary_little_endian or binary_big_endian, 1.0");
    EXPECT_EQ(fault("ply\n", "obj\n"),
              "mesh: line 1: found a file that does not begin with the line \"ply\", allowed: a PLY file");
    EXPECT_EQ(fault("end_header\n", ""),
              "mesh: line 11: found \"0 0 0 255\", allowed: format, element NAME COUNT, property TYPE NAME (after an "
              "element), comment or end_header");
}

TEST(ReadMeshTest, AFileThatIsMissingOrOfAnotherKindIsRefused) {
    const test::TemporaryFolder folder;
    const auto fault = [&](const std::string& name) {
        return fault_of([&](const std::string& file, const std::string&) { return read_mesh(folder.file(file)); },
                        name);
    };
    test::write_text(folder.file("a.ply"), ascii_ply);
    test::write_text(folder.file("b.PLY"), ascii_ply);
    test::write_text(folder.file("a.stl"), "solid");
    EXPECT_EQ(fault("a.ply"), "");
    EXPECT_EQ(fault("b.PLY"), "");
    EXPECT_NE(fault("missing.ply").find("missing.ply"), std::string::npos);
    EXPECT_NE(fault("a.stl").find("found the ending \".stl\", allowed: "), std::string::npos) << fault("a.stl");
}

}  // namespace
}  // namespace pt
