// What a command writes beside its --out takes nobody's place.
#include "harness/files_beside.h"

#include <gtest/gtest.h>

#include "harness/failure.h"
#include "harness/files_read.h"
#include "harness/json_reader.h"
#include "tests/support/command.h"

namespace pt::test {
namespace {

std::string numbered(std::size_t n) { return "a_" + std::to_string(n) + ".ply"; }

std::string refusal(const std::string& file, const std::string& content, bool overwrite) {
    try {
        check_replacement(file, content, overwrite);
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

TEST(FilesBesideTest, TakesTheFirstFreeNameOrThatOfTheSameBytes) {
    const TemporaryFolder folder;
    write_text(folder.file("a_0.ply"), "foreign");
    std::filesystem::create_directory(folder.file("a_1.ply"));
    std::filesystem::create_symlink("nothing", folder.file("a_2.ply"));
    write_text(folder.file("a_4.ply"), "second");
    FilesBeside files(folder.file("a.json"));
    EXPECT_EQ(files.add(numbered, 0, "first"), "a_3.ply");
    EXPECT_EQ(files.add(numbered, 0, "second"), "a_4.ply");
    EXPECT_EQ(files.add(numbered, 0, "first"), "a_3.ply");
    EXPECT_EQ(files.add(numbered, 3, "third"), "a_5.ply");
    EXPECT_EQ(files.add(numbered, 9, "first"), "a_9.ply");
    files.write("scene");
    EXPECT_EQ(content_of(folder.file("a_0.ply")), "foreign");
    EXPECT_EQ(content_of(folder.file("a_3.ply")), "first");
    EXPECT_EQ(content_of(folder.file("a_4.ply")), "second");
    EXPECT_EQ(content_of(folder.file("a_5.ply")), "third");
    EXPECT_EQ(content_of(folder.file("a_9.ply")), "first");
    EXPECT_EQ(content_of(folder.file("a.json")), "scene");
    EXPECT_FALSE(std::filesystem::exists(folder.file("nothing")));
}

TEST(FilesBesideTest, WhereNothingIsWrittenEveryNameIsFree) {
    FilesBeside files;
    EXPECT_EQ(files.add([](std::size_t) { return "/"; }, 0, "x"), "/");
}

// A name that somebody took since it was found free, or a file that cannot be written: what is new is removed.
TEST(FilesBesideTest, AFailureLeavesWhatWasThere) {
    const TemporaryFolder folder;
    FilesBeside files(folder.file("a.json"));
    (void)files.add(numbered, 0, "first");
    (void)files.add(numbered, 1, "second");
    write_text(folder.file("a_1.ply"), "foreign");
    EXPECT_THROW(files.write("scene"), MachineError);
    EXPECT_EQ(folder.content(), std::vector<std::string>{"a_1.ply"});
    EXPECT_EQ(content_of(folder.file("a_1.ply")), "foreign");
}

TEST(FilesBesideTest, AnotherContentIsReplacedOnlyWhereTheCallSaysSo) {
    const TemporaryFolder folder;
    const std::string file = folder.file("a.json");
    EXPECT_EQ(refusal(file, "new", false), "");
    write_text(file, "old");
    EXPECT_EQ(refusal(file, "old", false), "");
    EXPECT_EQ(refusal(file, "new", true), "");
    EXPECT_EQ(refusal(file, "new", false),
              file +
                  ": output file: found a file that is there and holds something else, allowed: --overwrite, which "
                  "replaces it, or another --out");
}

TEST(FilesBesideTest, WhatWasReadIsNeverWrittenByWhateverName) {
    const TemporaryFolder folder;
    const std::string file = folder.file("a.json");
    write_text(file, "old");
    std::filesystem::create_directory(folder.file("sub"));
    std::filesystem::create_symlink("../a.json", folder.file("sub/link.json"));
    std::filesystem::create_hard_link(file, folder.file("hard.json"));
    EXPECT_EQ(read_earlier_output(file, 100), "old");
    EXPECT_EQ(refusal(file, "new", true), "");
    EXPECT_EQ(read_file(file), "old");
    for (const std::string name : {"a.json", "sub/../a.json", "sub/link.json", "hard.json"}) {
        EXPECT_EQ(refusal(folder.file(name), "old", true), "--out: file name: found \"" + folder.file(name) +
                                                               "\", which this call reads, allowed: another file");
    }
    EXPECT_EQ(refusal(folder.file("b.json"), "new", true), "");
}

}  // namespace
}  // namespace pt::test
