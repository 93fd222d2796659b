#include "harness/bench/compile_ahead.h"

#include <cerrno>
#include <csignal>
#include <cstring>
#include <thread>

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "harness/bench/progress.h"
#include "harness/cuda/backend.h"
#include "harness/error.h"

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
    // False when every writer is gone.
    bool read(std::uint32_t& value) const { return ::read(ends_[0], &value, sizeof value) == sizeof value; }

private:
    int ends_[2] = {-1, -1};
};

using Programs = std::vector<std::pair<std::string, std::function<void()>>>;

// In a child process: NVRTC compiles one program at a time in a process, whatever the threads (CUDA 13.0). The child
// calls nothing of CUDA but the compiler, and leaves without running what its parent registered to run at exit.
[[noreturn]] void compile_share(const Programs& programs, std::size_t worker, std::size_t workers, int done,
                                pid_t parent) {
    // A share holds the locks of its parent's files: one that outlived it would keep a resumed run from them.
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    std::signal(SIGINT, SIG_DFL);
    std::signal(SIGTERM, SIG_DFL);
    if (::getppid() != parent) {
        ::_exit(0);
    }
    for (std::size_t i = worker; i < programs.size(); i += workers) {
        try {
            programs[i].second();
        } catch (const std::exception&) {  // reported by who needs the program
        }
        const auto index = static_cast<std::uint32_t>(i);
        (void)!::write(done, &index, sizeof index);
    }
    ::_exit(0);
}

}  // namespace

void compile_ahead(const std::vector<CompileTask>& tasks) {
    std::map<std::string, std::function<void()>> programs;
    for (const CompileTask& task : tasks) {
        if (why_not_applicable(task.variant, features_of(*task.scene), Backend::cuda).empty()) {
            cuda::collect_programs(*task.scene, task.variant, task.architecture, programs);
        }
    }
    compile_programs(programs);
}

void compile_programs(const std::map<std::string, std::function<void()>>& programs) {
    const Programs missing(programs.begin(), programs.end());
    const std::size_t workers = std::min<std::size_t>(missing.size(), std::thread::hardware_concurrency());
    if (workers < 2) {
        return;
    }
    Progress progress("compile", missing.size());
    Pipe finished;
    std::vector<pid_t> children;
    const pid_t parent = ::getpid();
    for (std::size_t worker = 0; worker < workers; ++worker) {
        const pid_t child = ::fork();
        if (child == 0) {
            compile_share(missing, worker, workers, finished.write_end(), parent);
        }
        if (child > 0) {
            children.push_back(child);
        }
    }
    finished.close_write_end();
    for (std::uint32_t index = 0; finished.read(index);) {
        progress.step(missing[index].first);
    }
    for (const pid_t child : children) {
        (void)::waitpid(child, nullptr, 0);
    }
}

}  // namespace pt
