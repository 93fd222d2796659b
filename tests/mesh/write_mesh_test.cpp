// Written meshes: read back, they are the same bit for bit.
#include "harness/mesh/write_mesh.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "harness/failure.h"
#include "harness/mesh/generate.h"
#include "harness/mesh/read_mesh.h"
#include "tests/support/command.h"

namespace pt {
namespace {

std::vector<std::pair<std::string, Mesh>> meshes() {
    std::vector<std::pair<std::string, Mesh>> all;
    for (const Generator& generator : generators()) {
        std::uint32_t size = generator.least_size;
        while (generator.triangles(size) < 1000) {
            ++size;
        }
        all.emplace_back(generator.name, generator.make(size));
    }
    using limits = std::numeric_limits<float>;
    Mesh odd;
    odd.vertices = {{limits::max(), -0.0f, limits::denorm_min()},
                    {std::nextafter(0.1f, 1.0f), -limits::min(), 1e-30f},
                    {16777217.0f, 3.0f, -1.0f / 3.0f},
                    {7.0f, 8.0f, 9.0f}};  // of no triangle
    odd.triangles = {{2, 1, 0}};
    all.emplace_back("odd", odd);
    odd.normals = {{0.0f, 0.0f, 1.0f}, {-0.0f, 2.0f, 0.1f}, {0.6f, 0.0f, 0.8f}, {1.0f, 0.0f, 0.0f}};
    all.emplace_back("odd with normals", odd);
    return all;
}

TEST(WriteMeshTest, BothFormatsAreReadBackBitForBit) {
    const test::TemporaryFolder folder;
    for (const auto& [name, mesh] : meshes()) {
        for (const std::string ending : {".ply", ".obj"}) {
            const std::string file = folder.file(name + ending);
            write_mesh(mesh, file);
            const Mesh again = read_mesh(file);
            EXPECT_EQ(content_hash(again), content_hash(mesh)) << name << ending;
            EXPECT_EQ(again.triangles.size(), mesh.triangles.size()) << name << ending;
            EXPECT_EQ(again.normals.size(), mesh.normals.size()) << name << ending;
            EXPECT_EQ(again.degenerate_left_out, 0u) << name << ending;
        }
    }
}

// Two triangles over one edge, whose ends lie at other places of the image for each.
TEST(WriteMeshTest, TextureCoordinatesAreReadBackBitForBit) {
    Mesh mesh;
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0.1f}, {9, 9, 9}};
    mesh.triangles = {{0, 1, 2}, {3, 2, 1}};
    mesh.coordinates = {{{{0.0f, 0.1f}, {1.0f / 3.0f, 0.0f}, {-7.5f, 1e-30f}}},
                        {{{1.0f, 1.0f}, {-7.5f, 1e-30f}, {0.25f, -0.0f}}}};
    const test::TemporaryFolder folder;
    for (const bool has_normals : {false, true}) {
        mesh.normals.assign(has_normals ? 5 : 0, {0, 0, 1});
        for (const std::string ending : {".ply", ".obj"}) {
            const std::string file = folder.file("a" + ending);
            write_mesh(mesh, file);
            const Mesh again = read_mesh(file);
            EXPECT_EQ(again.coordinates, mesh.coordinates) << ending;
            EXPECT_EQ(again.vertices.size(), 5u) << ending;  // vertex 1 twice; vertex 4 is of no triangle
            EXPECT_EQ(again.normals.size(), has_normals ? 5u : 0u) << ending;
            ASSERT_EQ(again.triangles.size(), 2u);
            for (std::size_t i = 0; i < 2; ++i) {
                for (std::size_t corner = 0; corner < 3; ++corner) {
                    EXPECT_EQ(again.vertices[again.triangles[i][corner]], mesh.vertices[mesh.triangles[i][corner]]);
                }
            }
        }
    }
}

TEST(WriteMeshTest, AnotherEndingIsRefused) {
    const test::TemporaryFolder folder;
    EXPECT_THROW(write_mesh(generate_mesh("equal", 1), folder.file("a.stl")), InputError);
    EXPECT_THROW(write_mesh(generate_mesh("equal", 1), folder.file("a")), InputError);
    EXPECT_TRUE(folder.content().empty());
}

}  // namespace
}  // namespace pt
