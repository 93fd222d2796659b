#include "harness/ranks/ranks.h"

#include <csignal>
#include <cstdlib>
#include <cstring>

#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "harness/failure.h"
#include "harness/interrupt.h"
#include "harness/json_reader.h"
#include "harness/machine/machine.h"
#include "harness/ranks/launch.h"
#include "harness/ranks/mpi.h"
#include "harness/ranks/render_on_ranks.h"
#include "harness/say.h"

namespace pt {

namespace {

Ranks& ranks_of_this_process() {
    static Ranks ranks;
    return ranks;
}

std::string host_of_this_rank() {
    char name[256] = {};
    ::gethostname(name, sizeof name - 1);
    return name;
}

// Waits for the child process that is the actual rank, and turns its death by a signal (the kernel kills it when memory
// runs out) into an exit code. A launcher would otherwise return the signal.
int wait_for(pid_t child, const Launch& launch) {
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
        std::signal(signal, SIG_IGN);
    }
    int status = 0;
    while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    if (WIFEXITED(status)) {
        return WEXITSTATUS(status);
    }
    if (WTERMSIG(status) == SIGINT || WTERMSIG(status) == SIGTERM ||
        WTERMSIG(status) == SIGHUP) {  // signals by which a user stops all MPI ranks
        return exit_interrupted;
    }
    say("ptbench: rank {} of {} on {} was killed: {}\n", launch.rank, launch.count, host_of_this_rank(),
        ::strsignal(WTERMSIG(status)));
    return exit_machine_failed;
}

void end_with(pid_t parent) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (::getppid() != parent) {
        ::_exit(exit_machine_failed);
    }
}

// Checks that all ranks run the same build: rank 0 prints the fault, and every rank returns the exit code.
int check_builds() {
    const Json mine{{"host", host_of_this_rank()}, {"build", program_hash()}};
    std::string fault;
    for (const std::string& text : mpi::gather(mine.dump())) {
        const Json other = Json::parse(text);
        ranks_of_this_process().hosts.push_back(other.at("host"));
        if (fault.empty() && other.at("build") != mine.at("build")) {
            fault = fmt::format("rank {} on {}: found another build of ptbench (program {}), allowed: rank 0's ({})",
                                ranks().hosts.size() - 1, ranks().hosts.back(), other.at("build").get<std::string>(),
                                program_hash());
        }
    }
    const bool is_good = mpi::broadcast(fault).empty();
    if (!fault.empty()) {
        say("ptbench: {}\n", fault);
    }
    return is_good ? exit_good : exit_bad_input;
}

int lead_or_serve(const std::function<int()>& program) {
    if (const int fault = check_builds(); fault != exit_good) {
        return fault;
    }
    if (ranks().rank == 0) {
        const int exit_code = program();
        // A launcher sends SIGTERM to all ranks when one exits with another code than 0; rank 0 is ending by itself.
        std::signal(SIGTERM, SIG_IGN);
        end_ranks(exit_code);
        return exit_code;
    }
    // Only rank 0 reacts to signals; the other ranks end with it.
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
        std::signal(signal, SIG_IGN);
    }
    return serve_rank_0();
}

}  // namespace

const Ranks& ranks() { return ranks_of_this_process(); }

std::string on_ranks(const std::string& machine) {
    return ranks().count == 1 ? machine : fmt::format("{}-{}-ranks", machine, ranks().count);
}

int run_on_ranks(const std::function<int()>& program) {
    const Launch launch = launch_from([](const char* name) { return std::getenv(name); });
    if (launch.count == 1) {
        return program();
    }
    if (!mpi::is_built()) {
        if (launch.rank != 0) {
            return exit_bad_input;
        }
        throw InputError("command line", "processes", std::to_string(launch.count),
                         "one: this build of ptbench has no MPI (build it where libopenmpi-dev is installed)");
    }
    if (const std::string gpu = own_gpu(launch, std::getenv("CUDA_VISIBLE_DEVICES")); !gpu.empty()) {
        ::setenv("CUDA_VISIBLE_DEVICES", gpu.c_str(), 1);
    }
    const pid_t parent = ::getpid();
    const pid_t child = ::fork();
    if (child < 0) {
        throw MachineError(fmt::format("cannot start a process: {}", std::strerror(errno)));
    }
    if (child > 0) {
        return wait_for(child, launch);
    }
    end_with(parent);
    ranks_of_this_process() = mpi::start();
    const int exit_code = lead_or_serve(program);
    mpi::finish();
    return exit_code;
}

}  // namespace pt
