#include "harness/interrupt.h"

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <exception>

#include <semaphore.h>
#include <unistd.h>

#include "harness/failure.h"
#include "harness/say.h"

namespace pt {

namespace {

std::atomic<bool> is_requested = false;
sem_t wake;  // semaphore by which the signal handler wakes the watching thread

constexpr std::array ending_signals{SIGINT, SIGTERM, SIGHUP};

// Sets the handler of the interrupting signals. A SIGHUP that the caller ignores, as nohup does, stays ignored.
void set_handlers(void (*handler)(int)) {
    for (const int number : ending_signals) {
        struct sigaction known {};
        const bool is_ignored = ::sigaction(number, nullptr, &known) == 0 && known.sa_handler == SIG_IGN;
        if (number != SIGHUP || !is_ignored) {
            std::signal(number, handler);
        }
    }
}

extern "C" void on_signal(int) {
    const int kept = errno;
    is_requested = true;
    set_handlers(SIG_DFL);
    ::sem_post(&wake);
    errno = kept;
}

int end_with(const std::function<int()>& end) {
    try {
        return end ? end() : exit_interrupted;
    } catch (const InputError& error) {
        say("ptbench: {}\n", error.what());
        return exit_bad_input;
    } catch (const std::exception& error) {
        say("ptbench: {}\n", error.what());
        return exit_machine_failed;
    }
}

}  // namespace

Interrupt::Interrupt(std::chrono::milliseconds grace) : grace_(grace) {
    is_requested = false;
    ::sem_init(&wake, 0, 0);
    watcher_ = std::thread([this] { watch(); });
    set_handlers(on_signal);
}

Interrupt::~Interrupt() {
    set_handlers(SIG_DFL);
    {
        const std::lock_guard lock(mutex_);
        is_over_ = true;
    }
    changed_.notify_all();
    ::sem_post(&wake);
    watcher_.join();
    ::sem_destroy(&wake);
}

bool Interrupt::requested() const { return is_requested; }

void Interrupt::when_overdue(std::function<int()> end) {
    const std::lock_guard lock(mutex_);
    end_ = std::move(end);
}

void Interrupt::begin_end() {
    std::unique_lock lock(mutex_);
    is_ending_ = true;
    if (is_overdue_) {
        lock.unlock();
        while (true) {
            ::pause();
        }
    }
}

void Interrupt::watch() {
    while (::sem_wait(&wake) != 0 && errno == EINTR) {
    }
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, grace_, [this] { return is_over_; });
    if (is_over_ || is_ending_) {
        return;
    }
    is_overdue_ = true;
    const std::function<int()> end = end_;
    lock.unlock();
    const int exit_code = end_with(end);
    std::fflush(stdout);
    ::_exit(exit_code);
}

}  // namespace pt
