// Generated meshes: exact counts, closed where they say so, the same bits everywhere.
#include "harness/mesh/generate.h"

#include <cmath>
#include <map>
#include <tuple>

#include <gtest/gtest.h>

#include "harness/failure.h"
#include "harness/mesh/check_mesh.h"
#include "harness/mesh/exact_math.h"
#include "tests/mesh/edges.h"

namespace pt {
namespace {

// Sizes that a test can afford, the least among them.
std::vector<std::uint32_t> small_sizes(const Generator& generator) {
    std::vector<std::uint32_t> sizes;
    for (std::uint32_t size = generator.least_size; size <= generator.most_size && sizes.size() < 8; ++size) {
        if (generator.triangles(size) <= 100'000) {
            sizes.push_back(size);
        }
    }
    return sizes;
}

class GeneratorTest : public testing::TestWithParam<std::string> {
protected:
    const Generator& generator() const { return *find_generator(GetParam()); }
};

TEST_P(GeneratorTest, HasAsManyTrianglesAsItSays) {
    ASSERT_FALSE(small_sizes(generator()).empty());
    for (const std::uint32_t size : small_sizes(generator())) {
        Mesh mesh = generate_mesh(GetParam(), size);
        EXPECT_EQ(mesh.triangles.size(), generator().triangles(size)) << size;
        EXPECT_EQ(mesh.degenerate_left_out, generator().left_out(size)) << size;
        const std::uint32_t left_out = mesh.degenerate_left_out;
        EXPECT_NO_THROW(check_mesh(mesh, "mesh")) << size;
        EXPECT_EQ(mesh.degenerate_left_out, left_out) << size;
    }
    EXPECT_LE(generator().triangles(generator().most_size), most_triangles);
}

TEST_P(GeneratorTest, IsClosedWhereItSaysSo) {
    for (const std::uint32_t size : small_sizes(generator())) {
        const Mesh mesh = generate_mesh(GetParam(), size);
        const test::EdgeCounts edges = test::edge_counts(mesh);
        if (generator().closed) {
            EXPECT_EQ(edges.open, 0u) << size;
            EXPECT_EQ(edges.touching, 0u) << size;
            EXPECT_GT(test::signed_volume(mesh), 0.0) << size;
        } else {
            EXPECT_GT(edges.open + edges.touching, 0u) << size;
        }
    }
}

TEST_P(GeneratorTest, IsTheSameEachTimeAndAnotherAtAnotherSize) {
    const std::vector<std::uint32_t> sizes = small_sizes(generator());
    EXPECT_EQ(content_hash(generate_mesh(GetParam(), sizes[0])), content_hash(generate_mesh(GetParam(), sizes[0])));
    if (sizes.size() > 1) {
        EXPECT_NE(content_hash(generate_mesh(GetParam(), sizes[0])), content_hash(generate_mesh(GetParam(), sizes[1])));
    }
}

std::vector<std::string> generator_names() {
    std::vector<std::string> names;
    for (const Generator& generator : generators()) {
        names.emplace_back(generator.name);
    }
    return names;
}

INSTANTIATE_TEST_SUITE_P(All, GeneratorTest, testing::ValuesIn(generator_names()),
                         [](const auto& generator) { return generator.param; });

// What the same sources make with another compiler, on another machine: a change is a change of every mesh that results
// were measured with.
TEST(GenerateTest, MeshesHaveTheBitsThatTheyHadElsewhere) {
    const std::tuple<std::string, std::uint32_t, std::string> known[] = {
        {"icosphere", 3, "4cac8d2432e646cd"}, {"grid_sphere", 12, "dd98e4dffaeb73a9"},
        {"menger", 2, "27cc2b329c51655c"},    {"teapot", 3, "70b7cae97cbecb7b"},
        {"stadium", 3, "5a0b4e6d9c9dc16c"},   {"hairball", 2, "258e533cfc40a75e"},
        {"trefoil", 6, "a054eaeac63c2f51"},   {"tori", 1, "b69c237d8af6b07f"},
        {"needles", 500, "fe5e29f08797e6ff"}, {"equal", 500, "91a57713c75f2c3d"},
        {"terrain", 4, "a23f8da9457bbd2a"},   {"cornell", 5, "fea63adc7977175c"},
    };
    EXPECT_EQ(std::size(known), generators().size());
    for (const auto& [name, size, hash] : known) {
        EXPECT_EQ(content_hash(generate_mesh(name, size)), hash) << name;
    }
}

TEST(GenerateTest, TheSpongeKeepsTwentyOf27ThirdsEachTime) {
    double volume = 8.0;
    for (std::uint32_t level = 0; level <= 3; ++level, volume *= 20.0 / 27.0) {
        EXPECT_NEAR(test::signed_volume(generate_mesh("menger", level)), volume, 1e-6) << level;
    }
}

// Vertices at the same place made one.
Mesh welded(Mesh mesh) {
    std::map<std::array<float, 3>, std::uint32_t> first_at;
    for (std::uint32_t i = 0; i < mesh.vertices.size(); ++i) {
        first_at.try_emplace(mesh.vertices[i], i);
    }
    for (auto& triangle : mesh.triangles) {
        for (std::uint32_t& corner : triangle) {
            corner = first_at.at(mesh.vertices[corner]);
        }
    }
    return mesh;
}

TEST(GenerateTest, TheTeapotsPatchesMeetAndFaceOneWay) {
    for (const std::uint32_t n : {3u, 8u, 13u}) {
        const Mesh teapot = welded(generate_mesh("teapot", n));
        // Open are the rim of the body, the lid's, and both ends of the handle and of the spout: 4 + 4 + 4 x 2 sides.
        EXPECT_EQ(test::edge_counts(teapot).open, 16u * n) << n;
        EXPECT_EQ(test::edge_counts(teapot).touching, 0u) << n;
        EXPECT_GT(test::signed_volume(teapot), 0.0) << n;
    }
}

TEST(GenerateTest, TheCornellBoxIsThatOfTheScene) {
    const Mesh box = generate_mesh("cornell", 1);
    std::array<float, 3> low = box.vertices[0], high = low;
    for (const auto& vertex : box.vertices) {
        for (int i = 0; i < 3; ++i) {
            low[i] = std::min(low[i], vertex[i]);
            high[i] = std::max(high[i], vertex[i]);
        }
    }
    EXPECT_EQ(low, (std::array{-5.0f, 0.0f, -5.0f}));
    EXPECT_EQ(high, (std::array{5.0f, 10.0f, 5.0f}));
    // Seen from the middle of the room, no wall turns its back.
    for (std::size_t i = 0; i < 10; ++i) {
        const auto& [ia, ib, ic] = box.triangles[i];
        Mesh tetrahedron;
        tetrahedron.vertices = {box.vertices[ia], box.vertices[ib], box.vertices[ic], {0.0f, 5.0f, 0.0f}};
        tetrahedron.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
        EXPECT_GT(test::signed_volume(tetrahedron), 0.0) << i;
    }
}

TEST(GenerateTest, AnUnknownNameOrSizeIsRefusedInOneLine) {
    const auto message = [](std::string_view name, std::uint32_t size) -> std::string {
        try {
            (void)generate_mesh(name, size);
        } catch (const InputError& error) {
            return error.what();
        }
        return "";
    };
    EXPECT_TRUE(message("icospere", 1)
                    .starts_with("mesh generator: found \"icospere\" (did you mean \"icosphere\"?), allowed: "
                                 "icosphere, grid_sphere, menger, "))
        << message("icospere", 1);
    EXPECT_EQ(message("icosphere", 11), "mesh icosphere: size (levels of division): found 11, allowed: 0 to 10");
}

TEST(ExactMathTest, SineAndCosineAreThoseOfTheCLibrary) {
    for (int i = -20'000; i <= 20'000; ++i) {
        const double x = i * 0.0517;
        const SineCosine exact = exact_sine_cosine(x);
        EXPECT_NEAR(exact.sine, std::sin(x), 2.3e-16) << x;
        EXPECT_NEAR(exact.cosine, std::cos(x), 2.3e-16) << x;
    }
}

}  // namespace
}  // namespace pt
