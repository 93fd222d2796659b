// The command line of ptbench. Exit codes: 0 good, 1 check failed, 2 invalid input, 3 machine failed, 130 interrupted.
#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <functional>
#include <iostream>
#include <system_error>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "harness/cli/commands.h"
#include "harness/cli/known_names.h"
#include "harness/cli/start_anew.h"
#include "harness/crash.h"
#include "harness/failure.h"
#include "harness/machine/machine.h"
#include "harness/nearest_name.h"
#include "harness/ranks/ranks.h"
#include "harness/say.h"

namespace {

// Quotes an argument for a shell, if necessary.
std::string quoted(const std::string& argument) {
    constexpr const char* plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=.,:/@%^";
    if (!argument.empty() && argument.find_first_not_of(plain) == std::string::npos) {
        return argument;
    }
    std::string text = "'";
    for (const char character : argument) {
        text += character == '\'' ? std::string("'\\''") : std::string(1, character);
    }
    return text + "'";
}

std::string join_arguments(int argc, char** argv) {
    std::string joined = pt::ranks().count > 1 ? fmt::format("mpirun -n {} ", pt::ranks().count) : "";
    for (int i = 0; i < argc; ++i) {
        joined += (i == 0 ? "" : " ") + quoted(argv[i]);
    }
    return joined;
}

// A suggestion for the first unknown argument; empty if no known name is similar.
std::string suggestion(const CLI::App& app, const std::vector<std::string>& arguments) {
    const std::vector<std::string> subcommands = pt::names_of_commands(app);
    if (arguments.empty()) {
        return "";
    }
    if (std::find(subcommands.begin(), subcommands.end(), arguments.front()) == subcommands.end()) {
        return pt::did_you_mean(arguments.front(), subcommands);
    }
    const std::vector<std::string> options = pt::option_names(*app.get_subcommand(arguments.front()));
    for (const std::string& argument : arguments) {
        const std::string name = argument.substr(0, argument.find('='));
        if (name.starts_with("--") && std::find(options.begin(), options.end(), name) == options.end()) {
            const std::string meant = pt::did_you_mean(name, options);
            return meant.empty() ? "" : fmt::format("; found {}{}", pt::one_line(name), meant);
        }
    }
    return "";
}

// Rewords an error of CLI11, such as "--seed: At Most 1 required but received 2".
std::string in_words(const CLI::ParseError& error) {
    const std::string message = error.what();
    const std::size_t place = message.find(": At Most 1 required but received");
    return place == std::string::npos ? message
                                      : fmt::format("{}: found it {} times, allowed: once", message.substr(0, place),
                                                    message.substr(message.find_last_of(' ') + 1));
}

// Refuses several MPI ranks for commands other than run and render, which would leave all ranks but one idle.
void check_ranks(const std::string& command) {
    if (pt::ranks().count > 1 && command != "run" && command != "render") {
        throw pt::InputError(
            "command line", "processes", fmt::format("{}", pt::ranks().count),
            fmt::format("one for `ptbench {}`; `ptbench run` and `ptbench render` take several", command));
    }
}

int run(int argc, char** argv) {
    CLI::App app("ptbench: does a path tracing optimisation pay? Measured, with the images compared first.", "ptbench");
    app.set_version_flag("--version", "ptbench " + pt::version_text());
    app.require_subcommand(0, 1);  // a missing subcommand is found later, so unknown arguments are reported first
    const std::vector<std::pair<std::string, pt::Command>> commands{
        {"list", pt::add_list_command(app)},
        {"run", pt::add_run_command(app, join_arguments(argc, argv))},
        {"merge", pt::add_merge_command(app, join_arguments(argc, argv))},
        {"render", pt::add_render_command(app)},
        {"verify", pt::add_verify_command(app)},
        {"inspect", pt::add_inspect_command(app)},
        {"autotune", pt::add_autotune_command(app)},
        {"import", pt::add_import_command(app)},
        {"export", pt::add_export_command(app)},
        {"generate", pt::add_generate_command(app)},
        {"machine", pt::add_machine_command(app)},
        {"new", pt::add_new_command(app)},
        {"replay", pt::add_replay_command(app)},
        {"completion", pt::add_completion_command(app)},
        {"stability", pt::add_stability_command(app, join_arguments(argc, argv))},
        {"rays", pt::add_rays_command(app, join_arguments(argc, argv))},
        {"passport", pt::add_passport_command(app, join_arguments(argc, argv))},
    };
    try {
        app.parse(argc, argv);
    } catch (const CLI::Success& success) {  // thrown by CLI11 for --help and --version
        return app.exit(success);
    } catch (const CLI::ParseError& error) {
        pt::say("ptbench: {}{} (see ptbench --help)\n", pt::one_line(in_words(error)),
                suggestion(app, {argv + 1, argv + argc}));
        return pt::exit_bad_input;
    }
    for (const auto& [name, command] : commands) {
        if (app.got_subcommand(name)) {
            check_ranks(name);
            return command();
        }
    }
    throw pt::InputError("command line", "subcommand", "none",
                         fmt::format("{} (see ptbench --help)", fmt::join(pt::names_of_commands(app), ", ")));
}

// Reports failed writes to standard output, for instance to a full disk, since the output may be a result.
int check_output(int exit_code) {
    std::cout.flush();
    errno = 0;
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0 || !std::cout) {
        throw pt::MachineError(fmt::format("standard output: cannot be written: {}",
                                           errno != 0 ? std::strerror(errno) : "a write failed"));
    }
    return exit_code;
}

// Calls `program` and returns its exit code; exceptions are reported in one line.
int guarded(const std::function<int()>& program) {
    try {
        return program();
    } catch (const pt::InputError& error) {
        pt::say("ptbench: {}\n", error.what());
        return pt::exit_bad_input;
    } catch (const pt::MachineError& error) {
        pt::say("ptbench: {}\n", error.what());
        return pt::exit_machine_failed;
    } catch (const std::system_error& error) {
        // fmt::print throws system_error if writing fails.
        const bool is_output = std::ferror(stdout) != 0;
        pt::say("ptbench: {}: {}\n", is_output ? "standard output: cannot be written" : "internal error",
                is_output ? error.code().message() : error.what());
        return pt::exit_machine_failed;
    } catch (const std::exception& error) {
        pt::say("ptbench: internal error: {}\n", error.what());
        return pt::exit_machine_failed;
    }
}

}  // namespace

int main(int argc, char** argv) {
    pt::occupy_standard_streams();
    // A write beyond the process's file size limit shall fail, like one to a full disk, instead of raising SIGXFSZ.
    std::signal(SIGXFSZ, SIG_IGN);
    // Line buffering: a crash loses no line that was printed before.
    std::setvbuf(stdout, nullptr, _IOLBF, BUFSIZ);
    pt::name_crashes();
    const auto program = [&] { return guarded([&] { return check_output(run(argc, argv)); }); };
    return guarded([&] {
        pt::start_anew(argv);
        return pt::run_on_ranks(program);
    });
}
