#include "harness/machine/machine.h"

#include <algorithm>
#include <cctype>
#include <chrono>
#include <ctime>
#include <fstream>

#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/resource.h>
#include <sys/utsname.h>
#include <thrust/version.h>

#include <unistd.h>

#include "build_info.h"  // header that every build generates
#include "harness/json_reader.h"
#include "harness/machine/cpu_clock.h"
#include "harness/machine/cpu_quota.h"
#include "variants/cpu/parallel_for.h"
#include "variants/fnv1a.h"

namespace pt {

namespace {

std::string value_in(const std::string& file, const std::string& key, char separator) {
    std::ifstream stream(file);
    for (std::string line; std::getline(stream, line);) {
        if (line.starts_with(key)) {
            const std::size_t start = line.find_first_not_of(" \t\"", line.find(separator) + 1);
            const std::size_t end = line.find_last_not_of(" \t\"");
            return start == std::string::npos ? "" : line.substr(start, end - start + 1);
        }
    }
    return "";
}

std::string cpu_model() {
    const std::string model = value_in("/proc/cpuinfo", "model name", ':');
    return model.empty() ? "unknown CPU" : model;
}

std::string operating_system() {
    utsname kernel{};
    uname(&kernel);
    return fmt::format("{}, Linux {}", value_in("/etc/os-release", "PRETTY_NAME", '='), kernel.release);
}

}  // namespace

std::string machine_name() {
    std::string name;
    for (const char c : cpu_model()) {
        const auto byte = static_cast<unsigned char>(c);
        if (std::isalnum(byte) != 0) {
            name += static_cast<char>(std::tolower(byte));
        } else if (!name.empty() && name.back() != '-') {
            name += '-';
        }
    }
    while (!name.empty() && name.back() == '-') {
        name.pop_back();
    }
    return fmt::format("{}-{}-threads", name, parallel_threads());
}

std::string program_hash() {
    static const std::string hash = [] {
        const std::string program = read_file("/proc/self/exe", largest_result);
        return fmt::format("{:016x}", fnv1a(program));
    }();
    return hash;
}

std::string openmp_environment() {
    std::vector<std::string> settings;
    for (char** variable = environ; *variable != nullptr; ++variable) {
        const std::string setting = *variable;
        if (setting.starts_with("OMP_") || setting.starts_with("GOMP_")) {
            settings.push_back(setting);
        }
    }
    std::sort(settings.begin(), settings.end());
    return fmt::format("{}", fmt::join(settings, " "));
}

ForeignLoad ForeignLoad::now() {
    ForeignLoad load;
    std::ifstream stat("/proc/stat");
    std::string name;
    double user = 0, nice = 0, system = 0, idle = 0, io_wait = 0, interrupts = 0, soft_interrupts = 0, stolen = 0;
    stat >> name >> user >> nice >> system >> idle >> io_wait >> interrupts >> soft_interrupts >> stolen;
    rusage own{};
    getrusage(RUSAGE_SELF, &own);
    const auto milliseconds = [](const timeval& time) {
        return 1e3 * static_cast<double>(time.tv_sec) + 1e-3 * static_cast<double>(time.tv_usec);
    };
    const double tick_ms = 1e3 / static_cast<double>(sysconf(_SC_CLK_TCK));
    const double all = (user + nice + system + interrupts + soft_interrupts + stolen) * tick_ms;
    load.cpu_ms = all - milliseconds(own.ru_utime) - milliseconds(own.ru_stime);
    load.involuntary_switches = own.ru_nivcsw;
    return load;
}

std::string iso_date() {
    const std::time_t now = std::time(nullptr);
    std::tm local{};
    localtime_r(&now, &local);
    char text[64];
    std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%S%z", &local);
    return text;
}

double seconds_since_1970() {
    return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

std::string version_text() {
    return fmt::format("{} (commit {}{})", PTBENCH_VERSION, git_sha(),
                       git_dirty() ? ", with changes that are not committed" : "");
}

std::string git_sha() { return PTBENCH_GIT_SHA; }

std::string image_sources_hash() { return PTBENCH_IMAGE_SOURCES_HASH; }

bool git_dirty() { return PTBENCH_GIT_DIRTY != 0; }

MachineContext machine_context() {
    return {
        .version = PTBENCH_VERSION,
        .git_sha = git_sha(),
        .git_dirty = git_dirty() ? "true" : "false",
        .machine = machine_name(),
        .cpu_model = cpu_model(),
        .os = operating_system(),
        .compiler = PTBENCH_COMPILER,
        .compiler_flags = PTBENCH_COMPILER_FLAGS,
        .build_type = PTBENCH_BUILD_TYPE,
        .program_hash = program_hash(),
        .openmp_environment = openmp_environment(),
        .clock = clock_method(),
        .threads = std::to_string(parallel_threads()),
        .cpu_quota = quota_in_words(CpuGroups::of_this_process().quota()),
        .thrust_version = fmt::format("{}.{}.{}", THRUST_MAJOR_VERSION, THRUST_MINOR_VERSION, THRUST_SUBMINOR_VERSION),
        .thrust_system = "omp",
        .google_benchmark_version = PTBENCH_BENCHMARK_VERSION};
}

}  // namespace pt
