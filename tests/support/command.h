// Runs a program, as a user would: the tests of the command line.
#pragma once

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/support/places.h"

namespace pt::test {

// A new folder, removed with all that is in it at the end.
class TemporaryFolder {
public:
    TemporaryFolder() {
        std::string name = (std::filesystem::temp_directory_path() / "ptbench_test_XXXXXX").string();
        if (::mkdtemp(name.data()) == nullptr) {
            throw std::runtime_error("no temporary folder");
        }
        path_ = name;
    }
    ~TemporaryFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;

    std::string file(const std::string& name) const { return (path_ / name).string(); }
    const std::filesystem::path& path() const { return path_; }
    // The names of what is in it, sub-folders included, sorted.
    std::vector<std::string> content() const {
        std::vector<std::string> names;
        for (const auto& entry : std::filesystem::recursive_directory_iterator(path_)) {
            names.push_back(std::filesystem::relative(entry.path(), path_).string());
        }
        std::sort(names.begin(), names.end());
        return names;
    }

private:
    std::filesystem::path path_;
};

inline std::string content_of(const std::string& file) {
    std::ifstream stream(file, std::ios::binary);
    std::ostringstream text;
    text << stream.rdbuf();
    return text.str();
}

inline void write_text(const std::string& file, const std::string& text) {
    std::ofstream(file, std::ios::binary) << text;
}

struct CommandResult {
    int exit_code = -1;  // 128 + the signal that ended it
    std::string out, err;
};

struct CommandOptions {
    std::string folder = "";                                            // to run in; empty: here
    std::vector<std::pair<std::string, std::string>> environment = {};  // added to ours
};

// A program that runs; killed at the end of its life here if it is still running.
class RunningCommand {
public:
    RunningCommand(std::vector<std::string> arguments, const CommandOptions& options = {}) {
        std::vector<char*> argv;
        for (std::string& argument : arguments) {
            argv.push_back(argument.data());
        }
        argv.push_back(nullptr);
        const std::string out = output_.file("out"), err = output_.file("err");
        process_ = ::fork();
        if (process_ != 0) {
            return;
        }
        // OpenMP threads that spin while they wait make small renders slow where tests share cores.
        ::setenv("OMP_WAIT_POLICY", "passive", 1);
        // No device is seen, so that the outcome is the same with a GPU and without.
        ::setenv("CUDA_VISIBLE_DEVICES", "-1", 1);
        for (const auto& [name, value] : options.environment) {
            ::setenv(name.c_str(), value.c_str(), 1);
        }
        const bool ready = (options.folder.empty() || ::chdir(options.folder.c_str()) == 0) &&
                           ::dup2(::open(out.c_str(), O_WRONLY | O_CREAT, 0600), STDOUT_FILENO) >= 0 &&
                           ::dup2(::open(err.c_str(), O_WRONLY | O_CREAT, 0600), STDERR_FILENO) >= 0;
        if (ready) {
            ::execv(argv[0], argv.data());
        }
        ::_exit(127);
    }
    ~RunningCommand() {
        if (!ended_) {
            signal(SIGKILL);
            wait();
        }
    }
    RunningCommand(const RunningCommand&) = delete;
    RunningCommand& operator=(const RunningCommand&) = delete;

    void signal(int number) { ::kill(process_, number); }
    bool is_running() {
        poll(WNOHANG);
        return !ended_;
    }
    CommandResult wait() {
        poll(0);
        return {WIFEXITED(status_) ? WEXITSTATUS(status_) : 128 + WTERMSIG(status_), content_of(output_.file("out")),
                content_of(output_.file("err"))};
    }

private:
    void poll(int flags) {
        while (!ended_) {
            const pid_t waited = ::waitpid(process_, &status_, flags);
            if (waited == 0) {
                return;
            }
            ended_ = waited == process_ || errno != EINTR;
        }
    }

    TemporaryFolder output_;
    pid_t process_ = -1;
    int status_ = 0;
    bool ended_ = false;
};

inline CommandResult run_command(const std::vector<std::string>& arguments, const CommandOptions& options = {}) {
    return RunningCommand(arguments, options).wait();
}

// The arguments of a call of ptbench, and the environment in which it finds the repository's scenes.
inline std::vector<std::string> ptbench_arguments(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), program_file());
    return arguments;
}

inline CommandOptions in_repository(CommandOptions options = {}) {
    options.environment.insert(options.environment.begin(), {"PTBENCH_HOME", source_folder()});
    return options;
}

inline CommandResult ptbench(std::vector<std::string> arguments, const CommandOptions& options = {}) {
    return run_command(ptbench_arguments(std::move(arguments)), in_repository(options));
}

// Waits until `condition()` holds or the limit is over; returns whether it holds.
template <class Condition>
bool wait_until(Condition condition, std::chrono::seconds limit = std::chrono::seconds(120)) {
    const auto end = std::chrono::steady_clock::now() + limit;
    while (!condition()) {
        if (std::chrono::steady_clock::now() > end) {
            return false;
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    return true;
}

}  // namespace pt::test
