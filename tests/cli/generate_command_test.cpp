// generate as a user calls it: what it prints, what it writes, and its exit codes.
#include <gtest/gtest.h>

#include "harness/mesh/generate.h"
#include "harness/mesh/read_mesh.h"
#include "tests/support/command.h"

namespace pt::test {
namespace {

using Arguments = std::vector<std::string>;

TEST(GenerateCommandTest, WithoutANameItListsTheMeshes) {
    const CommandResult result = ptbench({"generate"});
    EXPECT_EQ(result.exit_code, 0);
    EXPECT_EQ(result.err, "");
    for (const Generator& generator : generators()) {
        EXPECT_NE(("\n" + result.out).find("\n" + std::string(generator.name) + " "), std::string::npos)
            << generator.name;
    }
}

TEST(GenerateCommandTest, WhatItWritesIsTheMesh) {
    const TemporaryFolder folder;
    const CommandResult result =
        ptbench({"generate", "teapot", "--size", "4", "--out", "sub/teapot.ply"}, {.folder = folder.path()});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    const Mesh mesh = generate_mesh("teapot", 4);
    EXPECT_EQ(result.out, "teapot 4: 992 triangles, 800 vertices, 32 triangles without area left out, " +
                              content_hash(mesh) + " -> sub/teapot.ply\n");
    EXPECT_EQ(content_hash(read_mesh(folder.file("sub/teapot.ply"))), content_hash(mesh));
    EXPECT_EQ(folder.content(), (Arguments{"sub", "sub/teapot.ply"}));
}

TEST(GenerateCommandTest, AnotherFileIsReplacedOnlyWhereTheCallSaysSo) {
    const TemporaryFolder folder;
    write_text(folder.file("a.ply"), "mine");
    Arguments call{"generate", "icosphere", "--size", "0", "--out", "a.ply"};
    EXPECT_EQ(ptbench(call, {.folder = folder.path()}).exit_code, 2);
    EXPECT_EQ(content_of(folder.file("a.ply")), "mine");
    call.emplace_back("--overwrite");
    EXPECT_EQ(ptbench(call, {.folder = folder.path()}).exit_code, 0);
    EXPECT_EQ(read_mesh(folder.file("a.ply")).triangles.size(), 20u);
    call.pop_back();
    EXPECT_EQ(ptbench(call, {.folder = folder.path()}).exit_code, 0);  // the same bytes
}

TEST(GenerateCommandTest, ABadCallIsOneLineAndWritesNothing) {
    const TemporaryFolder folder;
    const auto refusal = [&](const Arguments& added) {
        Arguments arguments{"generate"};
        arguments.insert(arguments.end(), added.begin(), added.end());
        const CommandResult result = ptbench(arguments, {.folder = folder.path()});
        EXPECT_EQ(result.exit_code, 2) << result.out;
        EXPECT_EQ(result.out, "");
        return result.err;
    };
    EXPECT_EQ(refusal({"icosphere", "--out", "a.ply"}),
              "ptbench: generate: --size: found none, allowed: NAME --size N --out FILE\n");
    EXPECT_EQ(refusal({"icosphere", "--size", "1"}),
              "ptbench: generate: --out: found none, allowed: NAME --size N --out FILE\n");
    EXPECT_EQ(refusal({"--size", "1"}),
              "ptbench: generate: NAME: found none, allowed: the name of a mesh (`ptbench generate` lists them)\n");
    EXPECT_EQ(refusal({"icosphere", "--size", "1", "--out", "a.stl"}),
              "ptbench: --out: file name: found \"a.stl\", allowed: a name that ends in .ply or .obj\n");
    EXPECT_EQ(refusal({"icosphere", "--size", "11", "--out", "a.ply"}),
              "ptbench: mesh icosphere: size (levels of division): found 11, allowed: 0 to 10\n");
    EXPECT_NE(refusal({"icospere", "--size", "1", "--out", "a.ply"}).find("did you mean \"icosphere\"?"),
              std::string::npos);
    EXPECT_NE(refusal({"icosphere", "--size", "-1", "--out", "a.ply"}).find("--size"), std::string::npos);
    EXPECT_TRUE(folder.content().empty());
}

}  // namespace
}  // namespace pt::test
