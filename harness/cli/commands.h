// The subcommands of ptbench. Each function adds a subcommand to the command line and returns what runs it.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "harness/failure.h"
#include "variants/descriptor.h"

namespace pt {

// Runs a command and returns the exit code. May throw InputError and MachineError.
using Command = std::function<int()>;

Command add_list_command(CLI::App& app);
Command add_run_command(CLI::App& app, const std::string& command_line);
Command add_merge_command(CLI::App& app, const std::string& command_line);
Command add_render_command(CLI::App& app);
Command add_verify_command(CLI::App& app);
Command add_inspect_command(CLI::App& app);
Command add_autotune_command(CLI::App& app);
Command add_import_command(CLI::App& app);
Command add_export_command(CLI::App& app);
Command add_generate_command(CLI::App& app);
Command add_machine_command(CLI::App& app);
Command add_new_command(CLI::App& app);
Command add_completion_command(CLI::App& app);
Command add_replay_command(CLI::App& app);
Command add_stability_command(CLI::App& app, const std::string& command_line);
Command add_passport_command(CLI::App& app, const std::string& command_line);
Command add_rays_command(CLI::App& app, const std::string& command_line);

// The kinds of files that `ptbench new` can write, "compaction" for instance.
std::vector<std::string> kinds_of_new();
// The options of a command, "--axis" for instance, for suggestions.
std::vector<std::string> option_names(const CLI::App& command);
// Parses a resolution, "WxH"; throws InputError.
std::pair<std::uint32_t, std::uint32_t> parse_resolution(const std::string& text);
// Parses distinct resolutions, "WxH,WxH"; throws InputError.
std::vector<std::pair<std::uint32_t, std::uint32_t>> parse_resolutions(const std::string& text);
// Parses distinct whole numbers from `low` to `high`, "2,4,8". Throws InputError, naming `flag`, for anything else.
std::vector<std::uint32_t> parse_whole_numbers(const std::string& text, const std::string& flag, std::uint32_t low,
                                               std::uint32_t high);
// Splits "A,B", the value of `flag`, into {A, B}; throws InputError for an empty or repeated name.
std::vector<std::string> split_names(const std::string& text, const std::string& flag = "--scene");
// Splits "A,B" into scene names; "all" stands for every shipped scene. Throws InputError for an empty or repeated name.
std::vector<std::string> scenes_asked_for(const std::string& text);
// Parses the name of a backend, "cpu" or "cuda"; "" is cuda if available, else cpu. Throws InputError for another name,
// MachineError for a backend that this build lacks.
Backend parse_backend(const std::string& text);
// Throws MachineError, which says why, if the backend is not available.
void require_backend(Backend backend);
// Options `--compile --arch sm_NN`: compile the kernels that a call needs into the kernel cache and do nothing else,
// possibly on a machine without a GPU.
struct CompileOnly {
    bool is_asked = false;
    std::string architecture;
};
void add_compile_options(CLI::App& command, CompileOnly& compile_only);
// For CLI::Option::check: rejects an empty file name, as an unset shell variable gives; the result says what is wrong.
std::string check_not_empty(const std::string& text);
// For CLI::Option::check: rejects an invalid seed, such as -1, which CLI11 takes for 2^64 - 1.
std::string check_seed(const std::string& text);

}  // namespace pt
