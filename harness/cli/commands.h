// The subcommands of ptbench. Each adds itself to the command line and returns what to run if it was called.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "harness/error.h"
#include "variants/descriptor.h"

namespace pt {

// An exit code. May throw InputError and MachineError.
using Command = std::function<int()>;

Command add_list_command(CLI::App& app);
Command add_run_command(CLI::App& app, const std::string& command_line);
Command add_merge_command(CLI::App& app, const std::string& command_line);
Command add_render_command(CLI::App& app);
Command add_verify_command(CLI::App& app);
Command add_inspect_command(CLI::App& app);
Command add_autotune_command(CLI::App& app);
Command add_import_command(CLI::App& app);
Command add_machine_command(CLI::App& app);
Command add_new_command(CLI::App& app);
Command add_replay_command(CLI::App& app);
Command add_stability_command(CLI::App& app, const std::string& command_line);

// "WxH" -> {W, H}; throws InputError.
std::pair<std::uint32_t, std::uint32_t> parse_resolution(const std::string& text);
// "A,B" -> {A, B}, the scenes of --scene; throws InputError for an empty name.
std::vector<std::string> split_names(const std::string& text);
// "cpu" or "cuda"; "": cuda where it is available, else cpu. Throws InputError for another name, MachineError for a
// backend that this build lacks.
Backend parse_backend(const std::string& text);
// Throws MachineError with the reason if the backend is not available here.
void require_backend(Backend backend);
// For CLI::Option::check: what is wrong with a seed, or nothing. (CLI11 alone takes -1 for 2^64 - 1.)
std::string check_seed(const std::string& text);

}  // namespace pt
