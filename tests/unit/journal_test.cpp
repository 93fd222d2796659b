// The journal: what was written is there again, whatever happened in between.
#include "harness/bench/journal.h"

#include <algorithm>
#include <csignal>
#include <functional>
#include <utility>

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "tests/support/command.h"

namespace {

std::function<void()> before_flock;

}  // namespace

// The C library's, for a test that does something at the last moment. (A struct has the name too.)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wshadow"
extern "C" int flock(int descriptor, int operation) noexcept {
    if (const auto hook = std::exchange(before_flock, nullptr)) {
        hook();
    }
    return static_cast<int>(::syscall(SYS_flock, descriptor, operation));
}
#pragma GCC diagnostic pop

namespace pt {
namespace {

const Json identity{{"machine", "m"}, {"cells", {"a", "b"}}};

class JournalTest : public testing::Test {
protected:
    test::TemporaryFolder folder;
    std::string file = folder.file("result.json.journal.jsonl");

    // The message of the error that opening the journal throws, "" for none.
    template <class Error>
    std::string refusal(const Json& of = identity, bool resume = true) {
        try {
            const Journal journal(file, of, resume);
        } catch (const Error& error) {
            return error.what();
        }
        return "";
    }
    void write_three_facts() {
        Journal journal(file, identity, false);
        journal.set_cell("a", {{"status", "ok"}});
        journal.add_sample("a", {{"pt_wall_ms", 1.5}});
        journal.add_sample("a", {{"pt_wall_ms", 2.5}});
    }
};

TEST_F(JournalTest, AFreshOneIsEmpty) {
    const Journal journal(file, identity, false);
    EXPECT_EQ(journal.sample_count(), 0u);
    EXPECT_TRUE(journal.samples("a").empty());
    EXPECT_EQ(journal.cell("a"), nullptr);
}

TEST_F(JournalTest, ResumeOfNothingIsAFreshStart) {
    const Journal journal(file, identity, true);
    EXPECT_EQ(journal.sample_count(), 0u);
}

TEST_F(JournalTest, CreatesMissingFolders) {
    file = folder.file("new/folders/result.json.journal.jsonl");
    const Journal journal(file, identity, false);
    EXPECT_TRUE(std::filesystem::exists(file));
}

TEST_F(JournalTest, EveryFactIsInTheFileAtOnce) {
    Journal journal(file, identity, false);
    EXPECT_EQ(test::content_of(file), R"({"identity":{"cells":["a","b"],"machine":"m"},"type":"run"})"
                                      "\n");
    journal.add_sample("a", {{"pt_wall_ms", 1.5}});
    EXPECT_TRUE(test::content_of(file).ends_with(R"({"cell":"a","sample":{"pt_wall_ms":1.5},"type":"sample"})"
                                                 "\n"));
    journal.set_cell("b", {{"status", "ok"}});
    EXPECT_TRUE(test::content_of(file).ends_with(R"({"cell":"b","facts":{"status":"ok"},"type":"cell"})"
                                                 "\n"));
    EXPECT_EQ(journal.samples("a").size(), 1u);
    EXPECT_EQ(*journal.cell("b"), Json({{"status", "ok"}}));
}

TEST_F(JournalTest, ResumeHasWhatWasWrittenInItsOrder) {
    {
        Journal journal(file, identity, false);
        journal.add_sample("a", {{"pt_seed", 1}});
        journal.add_sample("b", {{"pt_seed", 1}});
        journal.add_sample("a", {{"pt_seed", 2}});
        journal.set_cell("a", {{"status", "ok"}});
        journal.set_cell("a", {{"status", "failed"}});
    }
    {
        Journal journal(file, identity, true);
        EXPECT_EQ(journal.sample_count(), 3u);
        ASSERT_EQ(journal.samples("a").size(), 2u);
        EXPECT_EQ(journal.samples("a")[0], Json({{"pt_seed", 1}}));
        EXPECT_EQ(journal.samples("a")[1], Json({{"pt_seed", 2}}));
        EXPECT_EQ(journal.samples("b").size(), 1u);
        EXPECT_EQ(journal.cell("a")->at("status"), "failed");  // the later fact replaces the earlier
        journal.add_sample("b", {{"pt_seed", 2}});
    }
    const Journal journal(file, identity, true);
    EXPECT_EQ(journal.sample_count(), 4u);
    EXPECT_EQ(journal.samples("b")[1], Json({{"pt_seed", 2}}));
}

TEST_F(JournalTest, DoublesComeBackBitForBit) {
    const double value = 0.1 + 0.2;
    {
        Journal journal(file, identity, false);
        journal.add_sample("a", {{"pt_wall_ms", value}});
    }
    const Journal journal(file, identity, true);
    EXPECT_EQ(journal.samples("a")[0].at("pt_wall_ms").get<double>(), value);
}

// A kill can cut the last line anywhere: every shorter file must open, with the whole lines in it and nothing else, and
// go on as if the cut line had never been begun.
TEST_F(JournalTest, ALastLineThatWasCutOffIsDroppedWhereverItWasCut) {
    write_three_facts();
    const std::string whole = test::content_of(file);
    for (std::size_t size = 0; size < whole.size(); ++size) {
        SCOPED_TRACE(size);
        test::write_text(file, whole.substr(0, size));
        const auto lines = static_cast<std::size_t>(
            std::count(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size), '\n'));
        {
            Journal journal(file, identity, true);
            ASSERT_EQ(journal.sample_count(), lines > 2 ? lines - 2 : 0);  // after the run's line and the cell's
            ASSERT_EQ(journal.cell("a") != nullptr, lines >= 2);
            journal.add_sample("b", {{"pt_wall_ms", 9}});
        }
        const Journal again(file, identity, true);
        ASSERT_EQ(again.samples("b").size(), 1u);
        ASSERT_EQ(again.sample_count(), (lines > 2 ? lines - 2 : 0) + 1);
    }
}

TEST_F(JournalTest, AnUnfinishedRunIsRefusedWithoutResume) {
    write_three_facts();
    const std::string before = test::content_of(file);
    EXPECT_EQ(refusal<InputError>(identity, false),
              file + ": found an unfinished run, allowed: --resume, which goes on, or --overwrite, which starts over");
    EXPECT_EQ(test::content_of(file), before);
}

TEST_F(JournalTest, AnotherRunIsRefused) {
    write_three_facts();
    const std::string before = test::content_of(file);
    EXPECT_EQ(refusal<InputError>({{"machine", "n"}, {"cells", {"a", "b"}}}),
              file +
                  ": line 1: found another run (machine: \"m\", here \"n\"), allowed: the run that it was started "
                  "with; remove "
                  "the file to start over");
    EXPECT_EQ(test::content_of(file), before);
    EXPECT_EQ(refusal<InputError>(), "");
}

TEST_F(JournalTest, ASecondWriterIsRefused) {
    const Journal first(file, identity, false);
    EXPECT_EQ(refusal<MachineError>(), file + ": another run is writing it");
    EXPECT_EQ(refusal<MachineError>(identity, false), file + ": another run is writing it");
}

TEST_F(JournalTest, ADamagedLineIsRefusedWithItsPlace) {
    write_three_facts();
    const std::string whole = test::content_of(file);
    const std::size_t second = whole.find('\n') + 1;
    for (const std::string damage :
         {"\n", "garbage\n", "{\"type\":\"sample\"\n", "{}\n", "[1]\n", "7\n", "{\"type\":5}\n",
          "{\"type\":\"other\"}\n", "{\"type\":\"sample\"}\n", "{\"type\":\"sample\",\"cell\":\"a\"}\n",
          "{\"type\":\"sample\",\"cell\":3,\"sample\":{}}\n", "{\"type\":\"cell\",\"cell\":\"a\"}\n", "\xff\xfe\n"}) {
        SCOPED_TRACE(damage);
        const std::string damaged = whole.substr(0, second) + damage + whole.substr(second);
        test::write_text(file, damaged);
        EXPECT_EQ(refusal<InputError>(),
                  file + ": byte " + std::to_string(second) +
                      ": found a damaged line, allowed: lines that ptbench wrote; remove the file to "
                      "start over");
        EXPECT_EQ(test::content_of(file), damaged);
    }
    test::write_text(file, "{\"type\":\"sample\"}\n");  // and a first line that is not the run's
    EXPECT_NE(refusal<InputError>().find(": line 1: found no line of a run, allowed: "), std::string::npos);
}

TEST_F(JournalTest, WhatMayDifferDoesNotRefuse) {
    write_three_facts();
    const Json other{{"machine", "n"}, {"cells", {"a", "b"}}};
    EXPECT_THROW(Journal(file, other, true, {"cells"}), InputError);
    EXPECT_EQ(Journal(file, other, true, {"machine"}).sample_count(), 2u);
    EXPECT_EQ(refusal<InputError>(), "");  // it still is the first one's
}

TEST(DifferenceTest, NamesWhatDiffersByItsKeys) {
    EXPECT_EQ(difference(identity, identity), "");
    EXPECT_EQ(difference({{"a", 1}, {"b", {{"c", "x"}, {"d", 2}}}}, {{"a", 1}, {"b", {{"c", "y"}, {"d", 2}}}}),
              "b c: \"x\", here \"y\"");
    EXPECT_EQ(difference({{"shard", "1/2"}}, Json::object()), "shard: \"1/2\", here none");
    EXPECT_EQ(difference(Json::object(), {{"shard", "1/2"}}), "shard: none, here \"1/2\"");
    EXPECT_EQ(difference({{"cells", {"p", "q"}}}, {{"cells", {"p", "r", "s"}}}),
              "cells: 2 of them, here 3; number 2 is \"q\", here \"r\"");
    EXPECT_EQ(difference({{"cells", {"p", "q"}}}, {{"cells", {"p"}}}),
              "cells: 2 of them, here 1; number 2 is \"q\", here none");
    EXPECT_EQ(difference({{"a", 1}, {"b", 1}, {"c", 1}, {"d", 1}, {"e", 1}}, Json::object()),
              "a: 1, here none; b: 1, here none; c: 1, here none; and 2 more");
    EXPECT_EQ(difference("identity", 7), "\"identity\", here 7");
}

TEST_F(JournalTest, KnowsWhichSessionTookHowManySamples) {
    {
        Journal journal(file, identity, false);
        journal.add_session({{"host_name", "x"}});
        journal.add_sample("a", {{"pt_seed", 1}});
        journal.add_sample("b", {{"pt_seed", 1}});
    }
    {
        Journal journal(file, identity, true);
        journal.add_session({{"host_name", "y"}});
        journal.add_sample("a", {{"pt_seed", 2}});
    }
    const Journal journal(file, identity, true);
    EXPECT_EQ(Json(journal.sessions()),
              Json({{{"host_name", "x"}, {"samples", 2}}, {{"host_name", "y"}, {"samples", 1}}}));
}

// Whoever had the lock may remove the file between another one's opening it and locking it: that one must not write
// into a file that has no name any more.
TEST_F(JournalTest, AFileThatGoesBeforeItIsLockedIsMadeAnew) {
    auto first = std::make_unique<Journal>(file, identity, false);
    before_flock = [&] {
        first->finish();
        first.reset();
    };
    Journal second(file, identity, true);
    EXPECT_EQ(first, nullptr);
    second.add_sample("a", {{"pt_seed", 1}});
    EXPECT_EQ(std::ranges::count(test::content_of(file), '\n'), 2);
    EXPECT_EQ(refusal<MachineError>(), file + ": another run is writing it");
}

TEST_F(JournalTest, FinishRemovesTheFile) {
    Journal journal(file, identity, false);
    journal.add_sample("a", {{"pt_seed", 1}});
    journal.finish();
    EXPECT_FALSE(std::filesystem::exists(file));
}

TEST_F(JournalTest, AFolderThatCannotBeMadeIsTheMachinesFault) {
    test::write_text(folder.file("plain"), "a file, not a folder");
    file = folder.file("plain/result.journal.jsonl");
    EXPECT_EQ(refusal<MachineError>(), file + ": cannot be written: Not a directory");
}

// A full disk: the line does not fit. No half of it stays behind in front of later lines.
TEST_F(JournalTest, ALineThatDoesNotFitLeavesNothingBehind) {
    write_three_facts();
    const std::string before = test::content_of(file);
    std::signal(SIGXFSZ, SIG_IGN);
    rlimit unlimited{};
    ::getrlimit(RLIMIT_FSIZE, &unlimited);
    {
        Journal journal(file, identity, true);
        rlimit limited = unlimited;
        limited.rlim_cur = before.size() + 20;
        ::setrlimit(RLIMIT_FSIZE, &limited);
        EXPECT_THROW(journal.add_sample("a", {{"pt_wall_ms", 3.5}}), MachineError);
        EXPECT_EQ(journal.sample_count(), 2u);
        ::setrlimit(RLIMIT_FSIZE, &unlimited);
        EXPECT_EQ(test::content_of(file), before);
        journal.add_sample("a", {{"pt_wall_ms", 4.5}});
    }
    std::signal(SIGXFSZ, SIG_DFL);
    const Journal journal(file, identity, true);
    ASSERT_EQ(journal.sample_count(), 3u);
    EXPECT_EQ(journal.samples("a")[2], Json({{"pt_wall_ms", 4.5}}));
}

}  // namespace
}  // namespace pt
