#include "harness/say.h"

#include <cerrno>
#include <csignal>
#include <ctime>

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

namespace pt {

namespace {

// While a `WithoutPipeSignal` lives, writing to a pipe without a reader fails but raises no SIGPIPE. Only stderr is
// protected so: a closed pipe on standard output may still end ptbench, as in `ptbench list | head`.
class WithoutPipeSignal {
public:
    WithoutPipeSignal() noexcept {
        ::sigemptyset(&pipe_);
        ::sigaddset(&pipe_, SIGPIPE);
        sigset_t pending;
        ::sigpending(&pending);
        was_pending_ = ::sigismember(&pending, SIGPIPE) == 1;
        ::pthread_sigmask(SIG_BLOCK, &pipe_, &mask_);
    }
    ~WithoutPipeSignal() {
        const timespec at_once{};
        while (!was_pending_ && ::sigtimedwait(&pipe_, nullptr, &at_once) < 0 && errno == EINTR) {
        }
        ::pthread_sigmask(SIG_SETMASK, &mask_, nullptr);
    }
    WithoutPipeSignal(const WithoutPipeSignal&) = delete;
    WithoutPipeSignal& operator=(const WithoutPipeSignal&) = delete;

private:
    sigset_t pipe_, mask_;
    bool was_pending_ = false;
};

// Waits up to 50 ms for room in standard error, which may be non-blocking where programs share a terminal.
bool has_room_again() noexcept {
    pollfd room{.fd = STDERR_FILENO, .events = POLLOUT, .revents = 0};
    constexpr int most_ms = 50;
    return ::poll(&room, 1, most_ms) > 0 && (room.revents & POLLOUT) != 0;
}

}  // namespace

void write_to_stderr(std::string_view text) noexcept {
    const int kept = errno;
    {
        const WithoutPipeSignal without;
        while (!text.empty()) {
            const ssize_t written = ::write(STDERR_FILENO, text.data(), text.size());
            if (written > 0) {
                text.remove_prefix(static_cast<std::size_t>(written));
            } else if (written == 0 || (errno != EINTR && (errno != EAGAIN || !has_room_again()))) {
                break;
            }
        }
    }
    errno = kept;
}

void occupy_standard_streams() noexcept {
    for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
        if (::fcntl(stream, F_GETFD) < 0 && errno == EBADF) {
            (void)::open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY);
        }
    }
}

}  // namespace pt
