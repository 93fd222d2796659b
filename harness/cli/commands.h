// The subcommands of ptbench. Each adds itself to the command line and returns what to run if it was called.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "harness/failure.h"
#include "variants/descriptor.h"

namespace pt {

// Carries a command out, and returns the exit code. May throw InputError and MachineError.
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
Command add_rays_command(CLI::App& app, const std::string& command_line);

// The kinds of things that `ptbench new` makes, "compaction" for instance.
std::vector<std::string> kinds_of_new();
// A command's options, "--axis" for instance, for suggestions.
std::vector<std::string> option_names(const CLI::App& command);
// Reads a resolution, "WxH"; throws InputError.
std::pair<std::uint32_t, std::uint32_t> parse_resolution(const std::string& text);
// Reads resolutions, "WxH,WxH", each of which may stand once; throws InputError.
std::vector<std::pair<std::uint32_t, std::uint32_t>> parse_resolutions(const std::string& text);
// Reads whole numbers, "2,4,8"; `flag` is for the messages. Throws InputError for what is no whole number from `low` to
// `high`, or stands twice.
std::vector<std::uint32_t> parse_whole_numbers(const std::string& text, const std::string& flag, std::uint32_t low,
                                               std::uint32_t high);
// Splits "A,B", the names of `flag`, into {A, B}; throws InputError for an empty name, or one that stands twice.
std::vector<std::string> split_names(const std::string& text, const std::string& flag = "--scene");
// Splits "A,B" into scene names; "all" stands for every shipped scene. Throws InputError for an empty name, or one that
// stands twice.
std::vector<std::string> scenes_asked_for(const std::string& text);
// Reads the name of a backend, "cpu" or "cuda"; "" is cuda where it is available, else cpu. Throws InputError for
// another name, MachineError for a backend that this build lacks.
Backend parse_backend(const std::string& text);
// Throws MachineError with the reason if the backend is not available here.
void require_backend(Backend backend);
// `--compile --arch sm_NN`: the kernels that a call would use are compiled into the cache, on a machine that may have
// no GPU, and nothing else is done.
struct CompileOnly {
    bool is_asked = false;
    std::string architecture;
};
void add_compile_options(CLI::App& command, CompileOnly& compile_only);
// For CLI::Option::check: what is wrong with an empty file name, which a shell's variable may have given; else nothing.
std::string check_not_empty(const std::string& text);
// For CLI::Option::check: what is wrong with a seed, or nothing. (CLI11 alone takes -1 for 2^64 - 1.)
std::string check_seed(const std::string& text);

}  // namespace pt
