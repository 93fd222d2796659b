// The journal: what was written is there again, whatever happened in between.
#include "harness/bench/journal.h"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <functional>
#include <sstream>
#include <utility>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>
#include <cerrno>
#include <cstring>

#include "tests/support/command.h"
#include "tests/support/sealed_lines.h"

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
const CellFacts failed{.status = CellStatus::failed, .reason = "why"};

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
        journal.set_cell("a", {});
        journal.add_sample("a", {.wall_ms = 1.5});
        journal.add_sample("a", {.wall_ms = 2.5});
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
    std::string expected = R"({"identity":{"cells":["a","b"],"machine":"m"},"type":"run"})"
                           "\n";
    EXPECT_EQ(test::content_of(file), test::sealed_lines(expected));
    journal.add_sample("a", {.wall_ms = 1.5});
    expected += R"({"cell":"a","sample":{"cpu_ms":0.0,"film_hash":"","pt_cache_hits":0,"pt_clock_unknown":0,)"
                R"("pt_connections":0,"pt_foreign_cpu_ms":0.0,"pt_graph_nodes":0,"pt_host_waits":0,)"
                R"("pt_involuntary_switches":0,"pt_launches":0,"pt_loop_rounds":0,"pt_order":0,"pt_paths":0,)"
                R"("pt_rays":0,"pt_rays_per_second":0.0,"pt_seed":0,"pt_spp":0,"pt_throttled_ms":0.0,)"
                R"("pt_throttled_periods":0,"pt_timestamp":0.0,"pt_wall_ms":1.5},"type":"sample"})"
                "\n";
    EXPECT_EQ(test::content_of(file), test::sealed_lines(expected));
    journal.set_cell("b", {});
    expected += R"({"cell":"b","facts":{"reason":"","status":"ok"},"type":"cell"})"
                "\n";
    EXPECT_EQ(test::content_of(file), test::sealed_lines(expected));
    EXPECT_EQ(journal.samples("a").size(), 1u);
    EXPECT_TRUE(journal.is_ok("b"));
}

TEST_F(JournalTest, ResumeHasWhatWasWrittenInItsOrder) {
    {
        Journal journal(file, identity, false);
        journal.add_sample("a", {.seed = 1});
        journal.add_sample("b", {.seed = 1});
        journal.add_sample("a", {.seed = 2});
        journal.set_cell("a", {});
        journal.set_cell("a", failed);
    }
    {
        Journal journal(file, identity, true);
        EXPECT_EQ(journal.sample_count(), 3u);
        ASSERT_EQ(journal.samples("a").size(), 2u);
        EXPECT_EQ(journal.samples("a")[0].seed, 1u);
        EXPECT_EQ(journal.samples("a")[1].seed, 2u);
        EXPECT_EQ(journal.samples("b").size(), 1u);
        EXPECT_TRUE(journal.has_failed("a"));  // the later fact replaces the earlier
        journal.add_sample("b", {.seed = 2});
    }
    const Journal journal(file, identity, true);
    EXPECT_EQ(journal.sample_count(), 4u);
    EXPECT_EQ(journal.samples("b")[1].seed, 2u);
}

TEST_F(JournalTest, ASampleAgainTakesTheOnesPlaceThatHasItsSeed) {
    const Sample first{.seed = 1, .order = 0}, second{.seed = 2, .order = 1};
    const Sample again{.seed = 1, .order = 2}, once_more{.seed = 1, .order = 3};
    {
        Journal journal(file, identity, false);
        journal.add_session({.host_name = "x"});
        journal.add_sample("a", first);
        journal.add_sample("a", second);
        journal.retake_sample("a", again);
        journal.retake_sample("a", once_more);
        EXPECT_EQ(journal.samples("a"), (std::vector<Sample>{once_more, second}));
        EXPECT_EQ(journal.retaken("a"), (std::vector<Sample>{first, again}));
    }
    const std::string whole = test::content_of(file);
    const Journal journal(file, identity, true);
    EXPECT_EQ(journal.samples("a"), (std::vector<Sample>{once_more, second}));
    EXPECT_EQ(journal.retaken("a"), (std::vector<Sample>{first, again}));
    EXPECT_EQ(journal.sessions()[0].samples, 4u);
    EXPECT_TRUE(journal.retaken("b").empty());
}

TEST_F(JournalTest, ASampleAgainOfNoneIsRefused) {
    write_three_facts();
    const std::string whole = test::content_of(file);
    for (const std::string& line : {Json{{"type", "retake"}, {"cell", "a"}, {"sample", Sample{.seed = 7}}}.dump(),
                                    Json{{"type", "retake"}, {"cell", "b"}, {"sample", Sample{.seed = 0}}}.dump(),
                                    std::string(R"({"type":"retake","cell":"a"})")}) {
        test::write_text(file, test::sealed_lines(whole + line + "\n"));
        EXPECT_EQ(refusal<InputError>().find(file + ": line 5: found no line of a session, a cell or a sample"), 0u)
            << refusal<InputError>();
    }
}

TEST_F(JournalTest, DoublesComeBackBitForBit) {
    const double value = 0.1 + 0.2;
    {
        Journal journal(file, identity, false);
        journal.add_sample("a", {.wall_ms = value});
    }
    const Journal journal(file, identity, true);
    EXPECT_EQ(journal.samples("a")[0].wall_ms, value);
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
            journal.add_sample("b", {.wall_ms = 9});
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

// FNV-1a written out once more.
TEST(LineSealTest, TheChecksumIsFnv1aOfTheLineAndOfThoseBeforeIt) {
    LineSeal seal;
    const std::string first = seal.seal(R"({"a":1})");
    std::uint64_t hash = 0xcbf29ce484222325ull;
    for (const char c : std::string(R"({"a":1})")) {
        hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3ull;
    }
    EXPECT_EQ(first, fmt::format(R"({{"a":1,"check":"{:016x}"}})", hash));
    for (const char c : std::string(R"({"b":2})")) {
        hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3ull;
    }
    EXPECT_EQ(seal.seal(R"({"b":2})"), fmt::format(R"({{"b":2,"check":"{:016x}"}})", hash));
}

// What a crash leaves: appended by hand, after the process's own lines.
TEST_F(JournalTest, TheNextLinesGoOnWithTheChecksums) {
    write_three_facts();
    std::string lines;
    {
        Journal journal(file, identity, true);
        journal.add_sample("a", {.wall_ms = 3.5});
        const Journal& known = journal;
        lines = known.next_lines({Journal::session_line({.process = 7}), Journal::cell_line("a", failed)});
        EXPECT_EQ(known.next_lines({}), "");
    }
    test::write_text(file, test::content_of(file) + lines);
    Journal again(file, identity, true);
    EXPECT_TRUE(again.has_failed("a"));
    EXPECT_EQ(again.sessions().size(), 1u);
    EXPECT_EQ(again.sample_count(), 3u);
    again.add_sample("b", {.wall_ms = 1});
    EXPECT_EQ(again.sample_count(), 4u);
}

TEST_F(JournalTest, AFlippedBitIsFoundWhereverItIs) {
    write_three_facts();
    const std::string whole = test::content_of(file);
    std::size_t line = 1;
    for (std::size_t at = 0; at < whole.size(); ++at) {
        const std::size_t bit = at % 8;
        SCOPED_TRACE(std::to_string(at) + ", bit " + std::to_string(bit));
        std::string damaged = whole;
        damaged[at] = static_cast<char>(damaged[at] ^ (1 << bit));
        test::write_text(file, damaged);
        if (at + 1 == whole.size()) {  // the end of the last line: as if it was cut off there
            const Journal journal(file, identity, true);
            EXPECT_EQ(journal.sample_count(), 1u);
            EXPECT_GT(journal.dropped_bytes(), 0u);
            continue;
        }
        const std::string place = file + ": line " + std::to_string(line) + ": found ";
        ASSERT_EQ(refusal<InputError>().find(place), 0u) << refusal<InputError>();
        ASSERT_EQ(test::content_of(file), damaged);
        line += whole[at] == '\n' ? 1 : 0;
    }
}

TEST_F(JournalTest, ALineThatIsLostOrTwiceOrInAnothersPlaceIsFound) {
    write_three_facts();
    std::vector<std::string> lines;
    std::istringstream stream(test::content_of(file));
    for (std::string line; std::getline(stream, line);) {
        lines.push_back(line + "\n");
    }
    ASSERT_EQ(lines.size(), 4u);
    const std::vector<std::pair<std::string, std::size_t>> damaged{
        {lines[0] + lines[2] + lines[3], 2},                        // without the second
        {lines[0] + lines[1] + lines[2] + lines[2] + lines[3], 4},  // the third twice
        {lines[0] + lines[1] + lines[3] + lines[2], 3},             // the last two exchanged
        {lines[1] + lines[2] + lines[3], 1}};                       // without the first
    for (const auto& [text, line] : damaged) {
        test::write_text(file, text);
        const std::string keep =
            line == 1 ? ""
                      : fmt::format("keep the {} before it (head -n {}) to go on from there, or ", line - 1, line - 1);
        EXPECT_EQ(
            refusal<InputError>(),
            fmt::format("{}: line {}: found another text than its checksum's: it was changed, or a line before it "
                        "was lost, moved or doubled, allowed: lines as ptbench wrote them; {}remove the file to "
                        "start over",
                        file, line, keep));
    }
    test::write_text(file, lines[0] + lines[1] + lines[2]);  // as that message says
    EXPECT_EQ(Journal(file, identity, true).sample_count(), 1u);
}

TEST_F(JournalTest, AJournalWithoutChecksumsIsRefused) {
    test::write_text(file, Json{{"type", "run"}, {"identity", identity}}.dump() + "\n");
    EXPECT_EQ(
        refusal<InputError>(),
        file +
            ": line 1: found no checksum at its end: it was changed, or an older ptbench wrote it, allowed: lines "
            "as ptbench wrote them; remove the file to start over");
}

TEST_F(JournalTest, ALineThatSaysNothingIsRefusedWithItsPlace) {
    write_three_facts();
    const std::string whole = test::content_of(file);
    const std::size_t second = whole.find('\n') + 1;
    for (const std::string line : {R"({"x":1})", R"({"type":5})", R"({"type":"other"})", R"({"type":"sample"})",
                                   R"({"type":"sample","cell":"a"})", R"({"type":"sample","cell":3,"sample":{}})",
                                   R"({"type":"cell","cell":"a"})", R"({"type":"run","identity":{}})", "{not JSON}"}) {
        SCOPED_TRACE(line);
        const std::string wrong = test::sealed_lines(whole.substr(0, second) + line + "\n" + whole.substr(second));
        test::write_text(file, wrong);
        EXPECT_EQ(refusal<InputError>(),
                  file +
                      ": line 2: found no line of a session, a cell or a sample, allowed: lines as ptbench wrote "
                      "them; keep the 1 before it (head -n 1) to go on from there, or remove the file to start over");
        EXPECT_EQ(test::content_of(file), wrong);
    }
    test::write_text(file, test::sealed_lines("{\"type\":\"sample\"}\n"));  // and a first line that is not the run's
    EXPECT_NE(refusal<InputError>().find(": line 1: found no line of a run, allowed: "), std::string::npos);
}

// By its key, and what stands there: nothing that no run writes is read as something else.
TEST_F(JournalTest, ASampleOrACellWithAWrongFactIsRefusedWithItsLine) {
    write_three_facts();
    const std::string whole = test::content_of(file);
    const auto refusal_of = [&](const Json& line) {
        test::write_text(file, test::sealed_lines(whole + line.dump() + "\n"));
        return refusal<InputError>();
    };
    const auto sample_with = [](const char* key, const Json& value) {
        Json sample(Sample{.wall_ms = 1, .checkpoints = std::vector<CheckpointFacts>(1)});
        value.is_discarded() ? (void)sample.erase(key) : (void)(sample[key] = value);
        return Json{{"type", "sample"}, {"cell", "a"}, {"sample", sample}};
    };
    const auto found = [&](const std::string& what) {
        return file + ": line 5: found a " + what +
               ", allowed: lines as ptbench wrote them; keep the 4 before it (head -n 4) to go on from there, or "
               "remove the file to start over";
    };
    const Json missing(Json::value_t::discarded);
    EXPECT_EQ(refusal_of(sample_with("pt_wall_ms", 2)), "");
    EXPECT_EQ(refusal_of(sample_with("pt_wall_ms", missing)), found("sample with no pt_wall_ms"));
    EXPECT_EQ(refusal_of(sample_with("film_hash", missing)), found("sample with no film_hash"));
    EXPECT_EQ(refusal_of(sample_with("pt_wall_ms", "1")), found("sample with pt_wall_ms \"1\""));
    EXPECT_EQ(refusal_of(sample_with("pt_rays", nullptr)), found("sample with pt_rays null"));
    EXPECT_EQ(refusal_of(sample_with("pt_rays", 1.5)), found("sample with pt_rays 1.5"));
    EXPECT_EQ(refusal_of(sample_with("pt_rays", -1)), found("sample with pt_rays -1"));
    EXPECT_EQ(refusal_of(sample_with("pt_spp", 5'000'000'000)), found("sample with pt_spp 5000000000"));
    EXPECT_EQ(refusal_of(sample_with("pt_clock_mhz_after", nullptr)), found("sample with pt_clock_mhz_after null"));
    EXPECT_EQ(refusal_of(sample_with("pt_checkpoints", Json::array({Json::object()}))),
              found("sample with pt_checkpoints: no bias2"));
    EXPECT_EQ(refusal_of({{"type", "sample"}, {"cell", "a"}, {"sample", 7}}), found("sample with 7, no object"));
    EXPECT_EQ(refusal_of({{"type", "cell"}, {"cell", "a"}, {"facts", 7}}), found("cell with 7, no object"));
    EXPECT_EQ(refusal_of({{"type", "cell"}, {"cell", "a"}, {"facts", {{"reason", ""}, {"status", "good"}}}}),
              found("cell with status: a status \"good\""));
    EXPECT_EQ(refusal_of({{"type", "retake"}, {"cell", "a"}, {"sample", Json::object()}}),
              found("retake with no cpu_ms"));
    EXPECT_EQ(refusal_of({{"type", "session"}, {"facts", Json::object()}}), found("session with no date"));
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
        journal.add_session({.host_name = "x"});
        journal.add_sample("a", {.seed = 1});
        journal.add_sample("b", {.seed = 1});
    }
    {
        Journal journal(file, identity, true);
        journal.add_session({.host_name = "y"});
        journal.add_sample("a", {.seed = 2});
    }
    const Journal journal(file, identity, true);
    EXPECT_EQ(journal.sessions(),
              (std::vector<SessionFacts>{{.host_name = "x", .samples = 2}, {.host_name = "y", .samples = 1}}));
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
    second.add_sample("a", {.seed = 1});
    EXPECT_EQ(std::ranges::count(test::content_of(file), '\n'), 2);
    EXPECT_EQ(refusal<MachineError>(), file + ": another run is writing it");
}

TEST_F(JournalTest, FinishRemovesTheFile) {
    Journal journal(file, identity, false);
    journal.add_sample("a", {.seed = 1});
    journal.finish();
    EXPECT_FALSE(std::filesystem::exists(file));
}

TEST_F(JournalTest, AFolderThatCannotBeMadeIsTheMachinesFault) {
    test::write_text(folder.file("plain"), "a file, not a folder");
    file = folder.file("plain/result.journal.jsonl");
    EXPECT_EQ(refusal<MachineError>(), file + ": cannot be written: Not a directory");
}

// Such as where somebody who is not root starts a package that root unpacked: what is said is not that the file is
// missing in a missing folder.
TEST_F(JournalTest, AFolderThatMayNotBeMadeIsToldByItsOwnReason) {
    const std::filesystem::path forbidden = "/sys/ptbench_test";
    std::error_code reason;
    std::filesystem::create_directories(forbidden, reason);
    if (!reason || reason.value() == ENOENT) {
        GTEST_SKIP() << "no folder here that nobody may make another in";
    }
    file = forbidden / "result.journal.jsonl";
    EXPECT_EQ(refusal<MachineError>(), file + ": cannot be written: " + reason.message());
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
        EXPECT_THROW(journal.add_sample("a", {.wall_ms = 3.5}), MachineError);
        EXPECT_EQ(journal.sample_count(), 2u);
        ::setrlimit(RLIMIT_FSIZE, &unlimited);
        EXPECT_EQ(test::content_of(file), before);
        journal.add_sample("a", {.wall_ms = 4.5});
    }
    std::signal(SIGXFSZ, SIG_DFL);
    const Journal journal(file, identity, true);
    ASSERT_EQ(journal.sample_count(), 3u);
    EXPECT_EQ(journal.samples("a")[2].wall_ms, 4.5);
}

}  // namespace
}  // namespace pt
