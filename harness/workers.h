// Processes that answer questions at once, a line for a line: what is checked by many small renders is mostly waiting
// for kernels that are too small for a GPU, and for checks that run on one core.
#pragma once

#include <sys/types.h>

#include <functional>
#include <string>
#include <vector>

namespace pt {

// A worker's answer to a question. Questions and answers are single lines.
using Answer = std::function<std::string(const std::string& question)>;

class Workers {
public:
    // Forks `count` processes that call `prepare`, if there is one, and then `answer`: before anything of CUDA or
    // OpenMP has started in this one, which neither outlives. What `prepare` throws is passed over. Throws
    // MachineError.
    Workers(std::size_t count, const Answer& answer, const std::function<void()>& prepare = {});
    // Ends the workers, which end when nobody asks any more.
    ~Workers();
    Workers(const Workers&) = delete;
    Workers& operator=(const Workers&) = delete;

    // Asks all questions, in order, each of a worker that is free, and hands on the answers in the order of the
    // questions, as soon as those before are there. Throws MachineError, naming the question, if a worker ends.
    void ask(const std::vector<std::string>& questions,
             const std::function<void(std::size_t, const std::string&)>& answered);

private:
    struct Worker {
        pid_t process = -1;
        int socket = -1;
        std::string received;  // of the answer that is on its way
        std::size_t question = ~std::size_t{0};
    };
    std::vector<Worker> workers_;
};

}  // namespace pt
