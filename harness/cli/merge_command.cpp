// `ptbench merge`: combines the shards of a run into one result file.
#include <filesystem>

#include <fmt/format.h>

#include "harness/bench/kept_result.h"
#include "harness/bench/merge.h"
#include "harness/bench/result_file.h"
#include "harness/cli/commands.h"
#include "harness/counted.h"
#include "harness/write_file.h"

namespace pt {

namespace {

int merge_files(const std::vector<std::string>& files, const std::string& out, bool overwrite,
                const std::string& command_line) {
    check_output_file(out);
    for (const std::string& file : files) {
        std::error_code ignored;
        if (std::filesystem::equivalent(file, out, ignored)) {
            throw InputError("--out", "file name", "\"" + out + "\", a shard", "a file of its own");
        }
    }
    check_overwrite(out, overwrite);
    const std::vector<ShardResult> shards = read_shards(files);
    const Merged merged = merge(shards, out, command_line);
    for (const auto& [from, to] : merged.copies) {
        write_file(to, read_file(from, largest_result));
    }
    write_file(out, rows_on_lines(merged.result) + "\n");
    std::size_t failed = 0, samples = 0;
    for (const auto& cell : merged.result.at("ptbench").at("cells")) {
        failed += cell.at("status") == "failed" ? 1u : 0u;
    }
    for (const auto& row : merged.result.at("benchmarks")) {
        samples += is_row_of_sample(row) ? 1u : 0u;
    }
    fmt::print("{}\n{}, {}, {} failed, {} not applicable, from {} on {}\n", out,
               counted(merged.result.at("ptbench").at("cells").size(), "cell"), counted(samples, "sample"), failed,
               merged.result.at("ptbench").at("not_applicable").size(), counted(shards.size(), "shard"),
               merged.result.at("context").at(BenchmarkContext::host_name_key).get<std::string>());
    return failed == 0 ? exit_good : exit_check_failed;
}

}  // namespace

Command add_merge_command(CLI::App& app, const std::string& command_line) {
    auto files = std::make_shared<std::vector<std::string>>();
    auto out = std::make_shared<std::string>();
    auto overwrite = std::make_shared<bool>(false);
    CLI::App* command = app.add_subcommand("merge", "Put the shards of a run together; write one result file");
    command->add_option("shards", *files, "The result files of every shard of one run")->required();
    command->add_option("--out", *out, "Result file")->required();
    command->add_flag("--overwrite", *overwrite, "Replace a result that is there");
    return [files, out, overwrite, command_line] { return merge_files(*files, *out, *overwrite, command_line); };
}

}  // namespace pt
