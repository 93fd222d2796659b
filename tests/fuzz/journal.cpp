// Journals: opened as `run --resume` opens them, gone on with, and made into a result file.
#include <filesystem>
#include <fstream>

#include <unistd.h>

#include "harness/bench/result_file.h"
#include "tests/fuzz/findings.h"
#include "tests/support/sealed_lines.h"

namespace pt::fuzz {
namespace {

// The cells that the corpus names: a plain one and one with checkpoints.
Plan small_plan() {
    auto scene = std::make_shared<Scene>();
    scene->name = "dark";
    Cell plain;
    plain.name = "plain";
    plain.scene = scene;
    plain.variant = Registry::instance().baseline();
    Cell checked = plain;
    checked.name = "checked";
    checked.convergence = CellConvergence{{1, 2}, {}, false};
    return {{plain, checked}, {}};
}

// One a process: fuzzers run side by side.
std::string journal_file() {
    return (std::filesystem::temp_directory_path() / ("ptbench_fuzz_journal." + std::to_string(::getpid()))).string();
}

void read_journal(const std::string& text) {
    static const Plan plan = small_plan();
    static const std::string file = journal_file();
    // With its checksums: a text that is refused for them says nothing of what is behind.
    std::ofstream(file, std::ios::binary) << test::sealed_lines(text);
    accept_or_refuse([&] {
        Journal journal(file, "identity", true);
        check_journal(plan, journal);
        RunFacts facts;
        facts.repetitions = 3;
        const std::string result = result_json(plan, {}, journal, facts);
        require(Json::accept(result), "a result that is no JSON");
        const std::size_t samples = journal.sample_count();
        journal.add_sample("plain", {.wall_ms = 1});
        require(journal.sample_count() == samples + 1, "a sample that is not counted");
    });
    std::filesystem::remove(file);
}

}  // namespace
}  // namespace pt::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    pt::fuzz::read_journal(pt::fuzz::text_of(data, size));
    return 0;
}
