// Generated meshes: exact counts, closed where they say so, the same bits everywhere.
#include "harness/mesh/generate.h"

#include <cmath>
#include <map>

#include <gtest/gtest.h>

#include "harness/error.h"
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

TEST(GenerateTest, AnUnknownNameOrSizeIsRefusedInOneLine) {
    const auto message = [](std::string_view name, std::uint32_t size) -> std::string {
        try {
            (void)generate_mesh(name, size);
        } catch (const InputError& error) {
            return error.what();
        }
        return "";
    };
    EXPECT_TRUE(
        message("icospere", 1)
            .starts_with(
                "mesh generator: found \"icospere\" (did you mean \"icosphere\"?), allowed: icosphere, grid_sphere"))
        << message("icospere", 1);
    EXPECT_EQ(message("icosphere", 11), "mesh icosphere: size (level of division): found 11, allowed: 0 to 10");
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
