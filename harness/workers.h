// Worker processes that answer one-line questions in parallel. They speed up checks made of many small renders, which
// mostly wait for kernels too small to fill a GPU and for work on one CPU core.
#pragma once

#include <sys/types.h>

#include <functional>
#include <string>
#include <vector>

namespace pt {

// A function that computes a worker's answer to a question. Questions and answers are single lines.
using Answer = std::function<std::string(const std::string& question)>;

class Workers {
public:
    // Forks `count` worker processes that call `prepare`, if given, and then `answer` each question. To be constructed
    // before this process has started CUDA or OpenMP, since neither survives a fork. Exceptions of `prepare` are
    // ignored. Throws MachineError if a process cannot be started.
    Workers(std::size_t count, const Answer& answer, const std::function<void()>& prepare = {});
    // Closes the workers' sockets, upon which the workers exit.
    ~Workers();
    Workers(const Workers&) = delete;
    Workers& operator=(const Workers&) = delete;

    // Asks all questions, in order, each of a free worker, and calls `answered` in the order of the questions, as soon
    // as all earlier answers have arrived. Throws MachineError, naming the question, if a worker dies.
    void ask(const std::vector<std::string>& questions,
             const std::function<void(std::size_t, const std::string&)>& answered);

private:
    struct Worker {
        pid_t process = -1;
        int socket = -1;
        std::string received;  // beginning of an answer that has not arrived in full
        std::size_t question = ~std::size_t{0};
    };
    std::vector<Worker> workers_;
};

}  // namespace pt
