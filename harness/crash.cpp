#include "harness/crash.h"

#include <algorithm>
#include <atomic>
#include <cstring>

#include <pthread.h>
#include <unistd.h>

#include "harness/failure.h"
#include "harness/say.h"

namespace pt {

namespace {

// A text that a signal handler may read: it allocates and frees nothing, and is complete whenever its length is not 0.
template <std::size_t Capacity>
struct Text {
    void set(const std::string& text) {
        const std::size_t size = std::min(text.size(), Capacity);
        std::memcpy(characters, text.data(), size);
        length.store(size);
    }
    void clear() { length.store(0); }

    char characters[Capacity];
    std::atomic<std::size_t> length = 0;
};

constexpr std::size_t most_levels = 4;
std::array<Text<2048>, most_levels> levels;
std::atomic<std::size_t> level_count = 0;

// Limit in bytes on a journal line written at a crash; a longer one is left out, as half a line corrupts the journal.
constexpr std::size_t longest_line = 256 * 1024;
std::array<Text<longest_line>, crash_signals.size()> last_lines;
std::atomic<int> last_descriptor = -1;
Text<4096> last_words;

std::atomic<bool> is_installed = false;
std::atomic<bool> is_crashing = false;
pthread_t worker;
pthread_t crashing;
bool has_bar_on_terminal = false;

void leave_last_line(std::size_t signal) {
    const int descriptor = last_descriptor.load();
    const Text<longest_line>& line = last_lines[signal];
    const std::size_t length = line.length.load();
    // One write call leaves a whole line in the journal or, if it fails, an incomplete last one, which readers drop.
    if (descriptor >= 0 && length > 0 && ::write(descriptor, line.characters, length) < 0) {
        write_to_stderr("ptbench: the crash could not be noted\n");
    }
}

// Handles a crash signal; calls only functions that POSIX allows in signal handlers.
extern "C" void on_crash(int number) {
    if (is_crashing.exchange(true)) {
        if (::pthread_equal(crashing, ::pthread_self()) != 0) {
            ::_exit(exit_machine_failed);  // the crash handler itself has crashed
        }
        while (true) {
            ::pause();  // another thread is already reporting a crash
        }
    }
    crashing = ::pthread_self();
    std::size_t signal = 0;
    while (signal + 1 < crash_signals.size() && crash_signals[signal].number != number) {
        ++signal;
    }
    write_to_stderr(has_bar_on_terminal ? "\nptbench: crashed, " : "ptbench: crashed, ");
    write_to_stderr(crash_signals[signal].name);
    const std::size_t count = level_count.load();
    for (std::size_t i = 0; i < count; ++i) {
        write_to_stderr(i == 0 ? ", in: " : ": ");
        write_to_stderr({levels[i].characters, levels[i].length.load()});
    }
    write_to_stderr("\n");
    leave_last_line(signal);
    write_to_stderr({last_words.characters, last_words.length.load()});
    ::_exit(exit_machine_failed);
}

}  // namespace

void name_crashes() {
    worker = ::pthread_self();
    has_bar_on_terminal = ::isatty(STDERR_FILENO) != 0;
    // The crash handler gets a stack of its own, since an overflowed stack has no room for it.
    static std::array<char, 64 * 1024> stack;
    const stack_t alternative{.ss_sp = stack.data(), .ss_flags = 0, .ss_size = stack.size()};
    ::sigaltstack(&alternative, nullptr);
    for (const CrashSignal& signal : crash_signals) {
        struct sigaction known {};
        if (::sigaction(signal.number, nullptr, &known) == 0 && known.sa_handler == SIG_DFL) {
            struct sigaction action {};
            action.sa_handler = on_crash;
            action.sa_flags = SA_ONSTACK;
            ::sigaction(signal.number, &action, nullptr);
        }
    }
    is_installed = true;
}

AtWork::AtWork(const std::string& what) {
    const std::size_t level = level_count.load();
    is_told_ = is_installed && ::pthread_equal(worker, ::pthread_self()) != 0 && level < most_levels;
    if (is_told_) {
        levels[level].set(one_line(what));
        level_count.store(level + 1);
    }
}

AtWork::~AtWork() {
    if (is_told_) {
        level_count.fetch_sub(1);
    }
}

LastLine::LastLine(int descriptor, const std::function<std::string(const std::string& signal)>& line,
                   const std::string& afterwards) {
    for (std::size_t i = 0; i < crash_signals.size(); ++i) {
        const std::string text = line(crash_signals[i].name);
        last_lines[i].set(text.size() <= longest_line ? text : "");
    }
    last_words.set(afterwards);
    last_descriptor.store(descriptor);
}

LastLine::~LastLine() {
    last_descriptor.store(-1);
    last_words.clear();
}

}  // namespace pt
