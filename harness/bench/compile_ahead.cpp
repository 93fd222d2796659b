#include "harness/bench/compile_ahead.h"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <thread>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "harness/bench/progress.h"
#include "harness/counted.h"
#include "harness/cuda/backend.h"
#include "harness/failure.h"

namespace pt {

namespace {

class Pipe {
public:
    Pipe() {
        if (::pipe2(ends_, O_CLOEXEC) != 0) {
            throw MachineError(std::string("no pipe: ") + std::strerror(errno));
        }
    }
    ~Pipe() {
        ::close(ends_[0]);
        close_write_end();
    }
    Pipe(const Pipe&) = delete;
    Pipe& operator=(const Pipe&) = delete;

    int write_end() const { return ends_[1]; }
    void close_write_end() {
        if (ends_[1] >= 0) {
            ::close(ends_[1]);
            ends_[1] = -1;
        }
    }
    // Reads the next number that a writer put into the pipe; returns false once all writers have closed the pipe.
    bool read(std::uint32_t& value) const { return ::read(ends_[0], &value, sizeof value) == sizeof value; }

private:
    int ends_[2] = {-1, -1};
};

using Programs = std::vector<std::pair<std::string, cuda::ProgramToCompile>>;

// Sorts CUDA programs so that those slow to compile come first: one that takes a minute should not start last.
Programs longest_first(const cuda::ProgramsToCompile& programs) {
    Programs ordered(programs.begin(), programs.end());
    std::stable_sort(ordered.begin(), ordered.end(),
                     [](const auto& a, const auto& b) { return a.second.features > b.second.features; });
    return ordered;
}

// A counter in memory that several processes share: each number from 0 on is handed out to one process only.
class SharedCounter {
public:
    SharedCounter() {
        void* const memory = ::mmap(nullptr, sizeof *next_, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
        if (memory == MAP_FAILED) {
            throw MachineError(std::string("no shared memory: ") + std::strerror(errno));
        }
        next_ = new (memory) std::atomic<std::uint32_t>(0);
    }
    ~SharedCounter() { ::munmap(next_, sizeof *next_); }
    SharedCounter(const SharedCounter&) = delete;
    SharedCounter& operator=(const SharedCounter&) = delete;

    std::uint32_t take() const { return next_->fetch_add(1); }

private:
    std::atomic<std::uint32_t>* next_ = nullptr;
};

constexpr std::uint32_t is_refused = 1u << 31;  // bit in a child process's message: its program did not compile

// Compiles some of the CUDA programs in a child process, because NVRTC compiles only one program at a time per process,
// whatever the number of threads (CUDA 13.0). The child calls nothing of CUDA but the compiler, and exits without
// running its parent's atexit handlers.
[[noreturn]] void compile_share(const Programs& programs, const SharedCounter& next, int done, pid_t parent) {
    // A child that outlived its parent process would keep inherited file locks, and a resumed run could not take them.
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    std::signal(SIGINT, SIG_DFL);
    std::signal(SIGTERM, SIG_DFL);
    if (::getppid() != parent) {
        ::_exit(0);
    }
    {
        const cuda::SharedHeaders headers;
        for (std::uint32_t i = next.take(); i < programs.size(); i = next.take()) {
            std::uint32_t report = i;
            try {
                programs[i].second.compile();
            } catch (const std::exception&) {  // a compile error is reported by the command that then needs the program
                report |= is_refused;
            }
            (void)!::write(done, &report, sizeof report);
        }
    }
    ::_exit(0);
}

double cpu_seconds_of_children() {
    rusage usage{};
    ::getrusage(RUSAGE_CHILDREN, &usage);
    const auto seconds = [](const timeval& time) {
        return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
    };
    return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

CompiledPrograms compile_in_processes(const Programs& programs, std::size_t workers) {
    const double before = cpu_seconds_of_children();
    Progress progress("compile", programs.size());
    Pipe finished;
    const SharedCounter next;
    std::vector<pid_t> children;
    const pid_t parent = ::getpid();
    for (std::size_t worker = 0; worker < workers; ++worker) {
        const pid_t child = ::fork();
        if (child == 0) {
            compile_share(programs, next, finished.write_end(), parent);
        }
        if (child > 0) {
            children.push_back(child);
        }
    }
    finished.close_write_end();
    CompiledPrograms result;
    for (std::uint32_t report = 0; finished.read(report);) {
        const std::string& program = programs[report & ~is_refused].first;
        if ((report & is_refused) != 0) {
            result.refused.push_back(program);
        } else {
            result.compiled += 1;
        }
        progress.step(program);
    }
    for (const pid_t child : children) {
        (void)::waitpid(child, nullptr, 0);
    }
    result.cpu_seconds = cpu_seconds_of_children() - before;
    return result;
}

// Why a program does not compile, by compiling it once more.
std::string refusal_of(const cuda::ProgramToCompile& program) {
    try {
        program.compile();
    } catch (const std::exception& error) {
        return error.what();
    }
    return "it compiles now";
}

cuda::ProgramsToCompile programs_of(const std::vector<CompileTask>& tasks) {
    cuda::ProgramsToCompile programs;
    for (const CompileTask& task : tasks) {
        if (why_not_applicable(task.variant, features_of(*task.scene), Backend::cuda).empty()) {
            cuda::collect_programs(*task.scene, task.variant, task.architecture, task.is_alone, programs);
        }
    }
    return programs;
}

}  // namespace

CompiledPrograms compile_ahead(const std::vector<CompileTask>& tasks) { return compile_programs(programs_of(tasks)); }

CompiledPrograms compile_programs(const cuda::ProgramsToCompile& programs) {
    const std::size_t workers = std::min<std::size_t>(programs.size(), std::thread::hardware_concurrency());
    return workers < 2 ? CompiledPrograms{} : compile_in_processes(longest_first(programs), workers);
}

void compile_for(const std::string& architecture, std::vector<CompileTask> tasks) {
    for (CompileTask& task : tasks) {
        task.architecture = architecture;
    }
    const auto missing = programs_of(tasks);
    const std::size_t processors = std::max<std::size_t>(1, std::thread::hardware_concurrency());
    CompiledPrograms done;
    if (!missing.empty()) {
        done = compile_in_processes(longest_first(missing), std::min(missing.size(), processors));
    }
    fmt::print("{} for {} compiled into {}, {:.1f} CPU seconds each\n", counted(done.compiled, "program"), architecture,
               cuda::kernel_cache(), done.compiled == 0 ? 0.0 : done.cpu_seconds / static_cast<double>(done.compiled));
    if (!done.refused.empty()) {
        throw MachineError(fmt::format("{} of {} programs did not compile; the first: {}", done.refused.size(),
                                       missing.size(), refusal_of(missing.at(done.refused.front()))));
    }
    if (done.compiled != missing.size()) {
        throw MachineError(fmt::format("{} of {} programs compiled: a process that compiles has ended early",
                                       done.compiled, missing.size()));
    }
}

}  // namespace pt
