// A file appears whole or not at all.
#include "harness/write_file.h"

#include <csignal>

#include <sys/resource.h>
#include <sys/stat.h>

#include <gtest/gtest.h>

#include "harness/failure.h"
#include "tests/support/command.h"

namespace pt {
namespace {

std::string refusal(const std::string& file) {
    try {
        write_file(file, "content");
    } catch (const MachineError& error) {
        return error.what();
    }
    return "";
}

TEST(WriteFileTest, WritesEveryByteAndNothingElse) {
    const test::TemporaryFolder folder;
    const std::string content("a\0b\r\n\xff", 6);
    write_file(folder.file("new"), content);
    EXPECT_EQ(test::content_of(folder.file("new")), content);
    write_file(folder.file("empty"), "");
    EXPECT_EQ(test::content_of(folder.file("empty")), "");
    EXPECT_EQ(folder.content(), (std::vector<std::string>{"empty", "new"}));
}

TEST(WriteFileTest, ReplacesAnOlderFile) {
    const test::TemporaryFolder folder;
    test::write_text(folder.file("result"), "the older one, which is longer");
    write_file(folder.file("result"), "new");
    EXPECT_EQ(test::content_of(folder.file("result")), "new");
}

TEST(WriteFileTest, ALinkStaysAndItsFileIsWritten) {
    const test::TemporaryFolder folder;
    write_file(folder.file("a/file"), "old");
    std::filesystem::create_symlink("a/file", folder.file("link"));
    write_file(folder.file("link"), "new");
    EXPECT_TRUE(std::filesystem::is_symlink(folder.file("link")));
    EXPECT_EQ(test::content_of(folder.file("a/file")), "new");
    std::filesystem::create_symlink("nowhere", folder.file("broken"));
    EXPECT_THROW(write_file(folder.file("broken"), "new"), MachineError);
    EXPECT_THROW(check_output_file(folder.file("broken")), InputError);
}

TEST(WriteFileTest, WhatIsNoRegularFileStays) {
    const test::TemporaryFolder folder;
    const std::string pipe = folder.file("pipe");
    ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
    for (const std::string& file : {pipe, std::string("/dev/full"), folder.path().string()}) {
        const auto kind = std::filesystem::status(file).type();
        EXPECT_THROW(write_file(file, "new"), MachineError);
        EXPECT_THROW(check_output_file(file), InputError);
        EXPECT_EQ(std::filesystem::status(file).type(), kind);
    }
    EXPECT_NO_THROW(check_output_file(folder.file("new/file")));
}

TEST(WriteFileTest, CreatesMissingFolders) {
    const test::TemporaryFolder folder;
    write_file(folder.file("a/b/result"), "new");
    EXPECT_EQ(test::content_of(folder.file("a/b/result")), "new");
}

// The limit on the size of a file stands for a full disk.
TEST(WriteFileTest, AFullDiskLeavesTheOldFile) {
    const test::TemporaryFolder folder;
    write_file(folder.file("result.json"), "old");
    std::signal(SIGXFSZ, SIG_IGN);
    rlimit unlimited{};
    ::getrlimit(RLIMIT_FSIZE, &unlimited);
    rlimit limited = unlimited;
    limited.rlim_cur = 4096;
    ::setrlimit(RLIMIT_FSIZE, &limited);
    std::string message;
    try {
        write_file(folder.file("result.json"), std::string(100'000, 'x'));
    } catch (const MachineError& error) {
        message = error.what();
    }
    ::setrlimit(RLIMIT_FSIZE, &unlimited);
    std::signal(SIGXFSZ, SIG_DFL);
    EXPECT_EQ(message, folder.file("result.json") + ": cannot be written: File too large");
    EXPECT_EQ(folder.content(), std::vector<std::string>{"result.json"});
    EXPECT_EQ(test::content_of(folder.file("result.json")), "old");
}

TEST(WriteFileTest, WhatKilledWritersLeftCanBeRemoved) {
    const test::TemporaryFolder folder;
    for (const char* name : {"result", "result.partial1", "result.partial234", "result.partial1x", "other.partial1"}) {
        test::write_text(folder.file(name), "");
    }
    remove_partial_files(folder.file("result"));
    EXPECT_EQ(folder.content(), (std::vector<std::string>{"other.partial1", "result", "result.partial1x"}));
    remove_partial_files(folder.file("missing/result"));
}

TEST(WriteFileTest, LeavesNothingWhereItCannotWrite) {
    const test::TemporaryFolder folder;
    test::write_text(folder.file("plain"), "a file, not a folder");
    EXPECT_EQ(refusal(folder.file("plain/result")),
              folder.file("plain/result") + ": cannot be written: a path through a file that is no folder");
    std::filesystem::create_directory(folder.file("taken"));
    EXPECT_EQ(refusal(folder.file("taken")), folder.file("taken") + ": cannot be written: a folder");
    EXPECT_EQ(folder.content(), (std::vector<std::string>{"plain", "taken"}));
    EXPECT_EQ(test::content_of(folder.file("plain")), "a file, not a folder");
}

}  // namespace
}  // namespace pt
