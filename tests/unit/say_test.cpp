// What is said on stderr where nobody takes it.
#include "harness/say.h"

#include <array>
#include <csignal>
#include <string>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

namespace pt {
namespace {

// Sends stderr to another descriptor for as long as it lives.
class StderrTo {
public:
    explicit StderrTo(int descriptor) : kept_(::dup(STDERR_FILENO)) { ::dup2(descriptor, STDERR_FILENO); }
    ~StderrTo() {
        ::dup2(kept_, STDERR_FILENO);
        ::close(kept_);
    }
    StderrTo(const StderrTo&) = delete;
    StderrTo& operator=(const StderrTo&) = delete;

private:
    int kept_;
};

bool has_pipe_signal_pending() {
    sigset_t pending;
    ::sigpending(&pending);
    return ::sigismember(&pending, SIGPIPE) == 1;
}

TEST(SayTest, EndsNoProgramWhosePipeNobodyReads) {
    std::array<int, 2> pipe{};
    ASSERT_EQ(::pipe(pipe.data()), 0);
    ::close(pipe[0]);
    ASSERT_EQ(std::signal(SIGPIPE, SIG_DFL), SIG_DFL);
    {
        const StderrTo nobody(pipe[1]);
        say("{}\n", 1);
        say("{}\n", 2);
    }
    EXPECT_FALSE(has_pipe_signal_pending());
    // Signals to the rest of the program are not held up.
    sigset_t mask;
    ::pthread_sigmask(SIG_SETMASK, nullptr, &mask);
    EXPECT_EQ(::sigismember(&mask, SIGPIPE), 0);
    ::close(pipe[1]);
}

TEST(SayTest, WritesAllOrWhatThereIsRoomFor) {
    std::array<int, 2> pipe{};
    ASSERT_EQ(::pipe2(pipe.data(), O_NONBLOCK), 0);
    {
        const StderrTo nobody_yet(pipe[1]);
        say("{}-{}\n", "a", 7);
        errno = ENOENT;
        say("{}", std::string(1 << 20, 'x'));  // more than a pipe holds
        EXPECT_EQ(errno, ENOENT);
    }
    std::string read(1 << 20, ' ');
    const ssize_t length = ::read(pipe[0], read.data(), read.size());
    ASSERT_GT(length, 5);
    EXPECT_EQ(read.substr(0, 5), "a-7\nx");
    ::close(pipe[0]);
    ::close(pipe[1]);
}

}  // namespace
}  // namespace pt
