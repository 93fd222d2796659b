#include "harness/workers.h"

#include <cerrno>
#include <csignal>
#include <cstring>
#include <map>

#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "harness/failure.h"
#include "harness/say.h"
#include "variants/cpu/share_threads.h"

namespace pt {

namespace {

constexpr std::size_t none = ~std::size_t{0};

// Sends a line through a socket; returns false if the other end is closed.
bool send_line(int socket, const std::string& text) {
    const std::string line = text + "\n";
    for (std::size_t sent = 0; sent < line.size();) {
        const ssize_t count = ::send(socket, line.data() + sent, line.size() - sent, MSG_NOSIGNAL);
        if (count < 0 && errno == EINTR) {
            continue;
        }
        if (count <= 0) {
            return false;
        }
        sent += static_cast<std::size_t>(count);
    }
    return true;
}

// Appends received bytes to `text`; returns false if the other end is closed.
bool receive(int socket, std::string& text) {
    char buffer[65536];
    for (;;) {
        const ssize_t count = ::recv(socket, buffer, sizeof buffer, 0);
        if (count < 0 && errno == EINTR) {
            continue;
        }
        if (count <= 0) {
            return false;
        }
        text.append(buffer, static_cast<std::size_t>(count));
        return true;
    }
}

// Answers questions in a child process until its parent is gone, and exits without running the parent's exit handlers.
[[noreturn]] void serve(int socket, const Answer& answer, const std::function<void()>& prepare, pid_t parent) {
    // The terminal sends SIGINT and SIGTERM to all processes of a command, but the parent decides whether to stop.
    // SIGKILL on the parent's death ends a worker even in the middle of a question.
    std::signal(SIGINT, SIG_IGN);
    std::signal(SIGTERM, SIG_IGN);
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (::getppid() != parent) {
        ::_exit(0);
    }
    try {
        if (prepare) {
            prepare();
        }
    } catch (const std::exception&) {  // NOLINT(bugprone-empty-catch): the first question meets it again, and tells it
    }
    std::string received;
    for (;;) {
        const std::size_t end = received.find('\n');
        if (end == std::string::npos) {
            if (!receive(socket, received)) {
                ::_exit(0);
            }
            continue;
        }
        const std::string question = received.substr(0, end);
        received.erase(0, end + 1);
        try {
            if (!send_line(socket, answer(question))) {
                ::_exit(0);
            }
        } catch (const std::exception& error) {
            say("ptbench: {}\n", error.what());
            ::_exit(1);
        }
    }
}

std::string ending(int status) {
    return WIFSIGNALED(status) ? fmt::format("ended by signal {} ({})", WTERMSIG(status), strsignal(WTERMSIG(status)))
                               : fmt::format("ended with exit code {}", WEXITSTATUS(status));
}

}  // namespace

Workers::Workers(std::size_t count, const Answer& answer, const std::function<void()>& prepare) : workers_(count) {
    const pid_t parent = ::getpid();
    const int threads = share_of_threads(count);  // OpenMP's thread count; some runtimes forget it in a forked child
    for (Worker& worker : workers_) {
        int ends[2];
        if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) {
            throw MachineError(std::string("no socket: ") + std::strerror(errno));
        }
        worker.process = ::fork();
        if (worker.process < 0) {
            throw MachineError(std::string("no process: ") + std::strerror(errno));
        }
        if (worker.process == 0) {
            // Copies of the parent's sockets would keep other workers from noticing that the parent is gone.
            for (const Worker& other : workers_) {
                if (other.socket >= 0) {
                    ::close(other.socket);
                }
            }
            ::close(ends[0]);
            use_threads(threads);
            serve(ends[1], answer, prepare, parent);
        }
        ::close(ends[1]);
        worker.socket = ends[0];
    }
}

Workers::~Workers() {
    for (const Worker& worker : workers_) {
        if (worker.socket >= 0) {
            ::close(worker.socket);
        }
    }
    for (const Worker& worker : workers_) {
        if (worker.process > 0) {
            (void)::waitpid(worker.process, nullptr, 0);
        }
    }
}

void Workers::ask(const std::vector<std::string>& questions,
                  const std::function<void(std::size_t, const std::string&)>& answered) {
    std::size_t next = 0, handed_on = 0;
    std::map<std::size_t, std::string> waiting;  // answers that wait until those to earlier questions arrive
    const auto give = [&](Worker& worker) {
        worker.question = next < questions.size() ? next++ : none;
        if (worker.question != none) {
            (void)send_line(worker.socket, questions[worker.question]);  // a dead worker is noticed on reading replies
        }
    };
    for (Worker& worker : workers_) {
        give(worker);
    }
    while (handed_on < questions.size()) {
        std::vector<pollfd> sockets;
        for (const Worker& worker : workers_) {
            sockets.push_back({worker.question != none ? worker.socket : -1, POLLIN, 0});
        }
        if (::poll(sockets.data(), sockets.size(), -1) < 0 && errno != EINTR) {
            throw MachineError(std::string("cannot wait for the workers: ") + std::strerror(errno));
        }
        for (std::size_t i = 0; i < workers_.size(); ++i) {
            Worker& worker = workers_[i];
            if (sockets[i].revents == 0) {
                continue;
            }
            if (!receive(worker.socket, worker.received)) {
                int status = 0;
                (void)::waitpid(worker.process, &status, 0);
                worker.process = -1;
                throw MachineError(fmt::format("a worker {} at {}", ending(status), questions[worker.question]));
            }
            if (worker.received.back() == '\n') {
                worker.received.pop_back();
                waiting[worker.question] = std::move(worker.received);
                worker.received.clear();
                give(worker);
            }
        }
        while (!waiting.empty() && waiting.begin()->first == handed_on) {
            answered(handed_on, waiting.begin()->second);
            waiting.erase(waiting.begin());
            ++handed_on;
        }
    }
}

}  // namespace pt
