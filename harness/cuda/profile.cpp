#include "harness/cuda/profile.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/wait.h>
#include <unistd.h>

#include "harness/cuda/is_program.h"
#include "harness/failure.h"

namespace pt::cuda {

namespace fs = std::filesystem;

namespace {

// Metrics in percent, which are averaged over a kernel's launches with the launches' times as weights.
constexpr std::pair<const char*, double KernelCounters::*> shares[] = {
    {"sm__warps_active.avg.pct_of_peak_sustained_active", &KernelCounters::occupancy},
    {"l1tex__throughput.avg.pct_of_peak_sustained_elapsed", &KernelCounters::l1},
    {"lts__throughput.avg.pct_of_peak_sustained_elapsed", &KernelCounters::l2},
    {"l1tex__t_sector_hit_rate.pct", &KernelCounters::l1_hit_rate},
    {"lts__t_sector_hit_rate.pct", &KernelCounters::l2_hit_rate},
    {"smsp__warp_issue_stalled_long_scoreboard_per_warp_active.pct", &KernelCounters::memory_stalls}};
// Metrics of ncu that are summed over launches.
constexpr std::pair<const char*, double KernelCounters::*> sums[] = {
    {"gpu__time_duration.sum", &KernelCounters::seconds},
    {"smsp__inst_executed.sum", &KernelCounters::instructions},
    {"smsp__thread_inst_executed.sum", &KernelCounters::thread_instructions},
    {"sm__inst_executed_pipe_fma.sum", &KernelCounters::fma},
    {"sm__inst_executed_pipe_alu.sum", &KernelCounters::alu},
    {"sm__inst_executed_pipe_xu.sum", &KernelCounters::xu},
    {"sm__inst_executed_pipe_lsu.sum", &KernelCounters::lsu},
    {"sm__inst_executed_pipe_fp64.sum", &KernelCounters::fp64},
    {"dram__bytes.sum", &KernelCounters::memory_bytes}};

std::string metric_names() {
    std::string names;
    for (const auto& [name, member] : sums) {
        names += (names.empty() ? "" : ",") + std::string(name);
    }
    for (const auto& [name, member] : shares) {
        names += "," + std::string(name);
    }
    return names;
}

// Splits a line of CSV into fields; a quoted field may contain commas, and quotes as pairs of quotes.
std::vector<std::string> csv_fields(const std::string& line) {
    std::vector<std::string> fields(1);
    bool quoted = false;
    for (std::size_t i = 0; i < line.size(); ++i) {
        if (line[i] == '"') {
            if (quoted && i + 1 < line.size() && line[i + 1] == '"') {
                fields.back() += line[++i];
            } else {
                quoted = !quoted;
            }
        } else if (line[i] == ',' && !quoted) {
            fields.emplace_back();
        } else {
            fields.back() += line[i];
        }
    }
    return fields;
}

// Parses a number of ncu such as "1,234.5" and converts it to seconds or bytes by `unit`, which ncu chooses freely.
double number(std::string text, const std::string& unit) {
    text.erase(std::remove(text.begin(), text.end(), ','), text.end());
    static const std::map<std::string, double> factors{
        {"ns", 1e-9}, {"nsecond", 1e-9}, {"us", 1e-6},   {"usecond", 1e-6}, {"ms", 1e-3},   {"msecond", 1e-3},
        {"s", 1},     {"second", 1},     {"Kbyte", 1e3}, {"Mbyte", 1e6},    {"Gbyte", 1e9}, {"Tbyte", 1e12}};
    const auto factor = factors.find(unit);
    return std::strtod(text.c_str(), nullptr) * (factor != factors.end() ? factor->second : 1.0);
}

struct Finished {
    int status = 0;
    std::string output;
};

Finished run(const std::vector<std::string>& command) {
    std::string line;
    for (const std::string& word : command) {
        std::string quoted = word;
        for (std::size_t at = 0; (at = quoted.find('\'', at)) != std::string::npos; at += 4) {
            quoted.replace(at, 1, "'\\''");
        }
        line += "'" + quoted + "' ";
    }
    FILE* const pipe = ::popen((line + "2>&1").c_str(), "r");
    if (pipe == nullptr) {
        throw MachineError(command.front() + ": cannot be run");
    }
    Finished finished;
    char buffer[4096];
    for (std::size_t got = 0; (got = std::fread(buffer, 1, sizeof buffer, pipe)) > 0;) {
        finished.output.append(buffer, got);
    }
    finished.status = ::pclose(pipe);
    return finished;
}

// Runs this program with the arguments `call` under ncu and returns the table that ncu writes.
std::string csv_under_ncu(const std::string& ncu, const std::vector<std::string>& options,
                          const std::vector<std::string>& call) {
    const fs::path log = fs::temp_directory_path() / fmt::format("ptbench-{}.ncu.csv", ::getpid());
    std::vector<std::string> command{ncu,         "--clock-control", "none", "--csv",      "--page",
                                     "raw",       "--print-units",   "base", "--log-file", log.string(),
                                     "--metrics", metric_names()};
    command.insert(command.end(), options.begin(), options.end());
    command.push_back(fs::read_symlink("/proc/self/exe").string());
    command.insert(command.end(), call.begin(), call.end());
    const Finished finished = run(command);
    std::ostringstream csv;
    csv << std::ifstream(log).rdbuf();
    std::error_code ignored;
    fs::remove(log, ignored);
    if (finished.status != 0) {
        throw MachineError(fmt::format("ncu failed: {}", csv.str().empty() ? finished.output : csv.str()));
    }
    if (parse_ncu_launches(csv.str()).empty()) {
        throw MachineError("ncu counted no kernel: " + csv.str());
    }
    return csv.str();
}

}  // namespace

std::string find_ncu() {
    if (const char* named = std::getenv("PTBENCH_NCU"); named != nullptr) {
        return is_program(named) ? named : "";
    }
    std::istringstream path(std::getenv("PATH") != nullptr ? std::getenv("PATH") : "");
    for (std::string folder; std::getline(path, folder, ':');) {
        if (is_program(fs::path(folder) / "ncu")) {
            return (fs::path(folder) / "ncu").string();
        }
    }
    return is_program("/usr/local/cuda/bin/ncu") ? "/usr/local/cuda/bin/ncu" : "";
}

std::vector<KernelCounters> parse_ncu_launches(const std::string& csv) {
    std::istringstream lines(csv);
    std::vector<std::string> names, units;
    std::vector<KernelCounters> launches;
    for (std::string line; std::getline(lines, line);) {
        if (line.rfind('"', 0) != 0) {
            continue;  // this line is a message of ncu: its CSV lines begin with a quote
        }
        const std::vector<std::string> fields = csv_fields(line);
        if (names.empty() || units.empty()) {
            (names.empty() ? names : units) = fields;
            continue;
        }
        const auto column = [&](const std::string& name) {
            const auto found = std::find(names.begin(), names.end(), name);
            if (found == names.end() || fields.size() != names.size() || units.size() != names.size()) {
                throw MachineError("ncu's table lacks the column " + name);
            }
            return static_cast<std::size_t>(found - names.begin());
        };
        KernelCounters counters;
        counters.name = fields[column("Kernel Name")].substr(0, fields[column("Kernel Name")].find('('));
        counters.launches = 1;
        for (const auto& [name, member] : sums) {
            counters.*member = number(fields[column(name)], units[column(name)]);
        }
        for (const auto& [name, member] : shares) {
            counters.*member = 1e-2 * number(fields[column(name)], units[column(name)]);
        }
        launches.push_back(counters);
    }
    return launches;
}

std::vector<KernelCounters> parse_ncu_csv(const std::string& csv) {
    std::map<std::string, KernelCounters> by_name;
    for (const KernelCounters& launch : parse_ncu_launches(csv)) {
        KernelCounters& counters = by_name[launch.name];
        counters.name = launch.name;
        counters.launches += 1;
        for (const auto& [name, member] : sums) {
            counters.*member += launch.*member;
        }
        for (const auto& [name, member] : shares) {
            counters.*member += launch.*member * launch.seconds;
        }
    }
    std::vector<KernelCounters> all;
    for (auto& [kernel, counters] : by_name) {
        for (const auto& [name, member] : shares) {
            counters.*member /= counters.seconds;
        }
        all.push_back(counters);
    }
    return all;
}

std::vector<KernelCounters> count_under_ncu(const std::string& ncu, const std::vector<std::string>& arguments,
                                            const std::vector<std::string>& kernels) {
    const fs::path image = fs::temp_directory_path() / fmt::format("ptbench-{}.pfm", ::getpid());
    std::vector<std::string> call{"render", "--untuned"};
    call.insert(call.end(), arguments.begin(), arguments.end());
    call.insert(call.end(), {"--out", image.string()});
    const auto remove_image = [&] {
        std::error_code ignored;
        fs::remove(image, ignored);
    };
    std::vector<KernelCounters> counters;
    try {
        counters =
            parse_ncu_csv(csv_under_ncu(ncu, {"-k", fmt::format("regex:^({})$", fmt::join(kernels, "|"))}, call));
    } catch (...) {
        remove_image();
        throw;
    }
    remove_image();
    return counters;
}

std::vector<KernelCounters> count_launches_under_ncu(const std::string& ncu,
                                                     const std::vector<std::string>& arguments) {
    std::vector<std::string> call{"rays", "--counted"};
    call.insert(call.end(), arguments.begin(), arguments.end());
    // Without cache control a batch finds the GPU's caches as the previous launch left them, as timed batches do.
    return parse_ncu_launches(csv_under_ncu(
        ncu, {"--profile-from-start", "off", "--cache-control", "none", "--print-kernel-base", "function"}, call));
}

nlohmann::ordered_json ceilings_json(const Ceilings& ceilings) {
    return {{"issue_g_warp_instructions_per_second", 1e-9 * ceilings.issue},
            {"fma_g_warp_instructions_per_second", 1e-9 * ceilings.fma},
            {"alu_g_warp_instructions_per_second", 1e-9 * ceilings.alu},
            {"xu_g_warp_instructions_per_second", 1e-9 * ceilings.xu},
            {"memory_gb_per_second", 1e-9 * ceilings.memory}};
}

nlohmann::ordered_json counters_json(const KernelCounters& c, const Ceilings& ceilings, double rays) {
    const std::pair<const char*, double> fractions[] = {{"issue", c.instructions / c.seconds / ceilings.issue},
                                                        {"fma", c.fma / c.seconds / ceilings.fma},
                                                        {"alu", c.alu / c.seconds / ceilings.alu},
                                                        {"xu", c.xu / c.seconds / ceilings.xu},
                                                        {"l1", c.l1},
                                                        {"l2", c.l2},
                                                        {"memory", c.memory_bytes / c.seconds / ceilings.memory}};
    nlohmann::ordered_json of_ceiling = nlohmann::ordered_json::object();
    for (const auto& [name, fraction] : fractions) {
        of_ceiling[name] = fraction;
    }
    const auto* const bound = std::max_element(std::begin(fractions), std::end(fractions),
                                               [](const auto& a, const auto& b) { return a.second < b.second; });
    return {{"launches", c.launches},
            {"milliseconds", 1e3 * c.seconds},
            {"active_lanes", c.thread_instructions / c.instructions},
            {"warp_instructions_per_ray", c.instructions / rays},
            {"thread_instructions_per_ray", c.thread_instructions / rays},
            {"fma_per_ray", c.fma / rays},
            {"alu_per_ray", c.alu / rays},
            {"xu_per_ray", c.xu / rays},
            {"lsu_per_ray", c.lsu / rays},
            {"fp64_per_ray", c.fp64 / rays},
            {"memory_bytes_per_ray", c.memory_bytes / rays},
            {"achieved_occupancy", c.occupancy},
            {"l1_hit_rate", c.l1_hit_rate},
            {"l2_hit_rate", c.l2_hit_rate},
            {"memory_stalls", c.memory_stalls},
            {"of_ceiling", of_ceiling},
            {"bound", bound->first}};
}

std::vector<nlohmann::ordered_json> batch_counters_json(const std::vector<KernelCounters>& launches,
                                                        const std::vector<CountedBatch>& batches,
                                                        const Ceilings& ceilings) {
    std::vector<nlohmann::ordered_json> counted;
    for (const KernelCounters& launch : launches) {
        if (counted.size() < batches.size() &&
            launch.name.find(batches[counted.size()].function) != std::string::npos) {
            counted.push_back(counters_json(launch, ceilings, batches[counted.size()].rays));
        } else {
            throw MachineError(fmt::format("ncu counted {}, where batch {} of {} was to come", launch.name,
                                           counted.size() + 1, batches.size()));
        }
    }
    if (counted.size() != batches.size()) {
        throw MachineError(fmt::format("ncu counted {} of {} batches", counted.size(), batches.size()));
    }
    return counted;
}

}  // namespace pt::cuda
