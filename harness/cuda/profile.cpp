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
#include "harness/error.h"

namespace pt::cuda {

namespace fs = std::filesystem;

namespace {

constexpr const char* metrics[] = {"gpu__time_duration.sum",
                                   "smsp__inst_executed.sum",
                                   "smsp__thread_inst_executed.sum",
                                   "sm__inst_executed_pipe_fma.sum",
                                   "sm__inst_executed_pipe_alu.sum",
                                   "sm__inst_executed_pipe_xu.sum",
                                   "sm__inst_executed_pipe_lsu.sum",
                                   "sm__inst_executed_pipe_fp64.sum",
                                   "dram__bytes.sum",
                                   "sm__warps_active.avg.pct_of_peak_sustained_active"};

// Fields of one line; a quoted field may hold commas, and two quotes for one.
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

// "1,234.5" in the unit's base: ncu scales as it likes and says so in the second line.
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

std::vector<KernelCounters> parse_ncu_csv(const std::string& csv) {
    std::istringstream lines(csv);
    std::vector<std::string> names, units;
    std::map<std::string, KernelCounters> by_name;
    for (std::string line; std::getline(lines, line);) {
        if (line.rfind('"', 0) != 0) {
            continue;  // ncu's own words
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
        const auto value = [&](const std::string& name) { return number(fields[column(name)], units[column(name)]); };
        const std::string kernel = fields[column("Kernel Name")].substr(0, fields[column("Kernel Name")].find('('));
        KernelCounters& counters = by_name[kernel];
        counters.name = kernel;
        counters.launches += 1;
        const double seconds = value("gpu__time_duration.sum");
        counters.seconds += seconds;
        counters.instructions += value("smsp__inst_executed.sum");
        counters.thread_instructions += value("smsp__thread_inst_executed.sum");
        counters.fma += value("sm__inst_executed_pipe_fma.sum");
        counters.alu += value("sm__inst_executed_pipe_alu.sum");
        counters.xu += value("sm__inst_executed_pipe_xu.sum");
        counters.lsu += value("sm__inst_executed_pipe_lsu.sum");
        counters.fp64 += value("sm__inst_executed_pipe_fp64.sum");
        counters.memory_bytes += value("dram__bytes.sum");
        counters.occupancy += 1e-2 * value("sm__warps_active.avg.pct_of_peak_sustained_active") * seconds;
    }
    std::vector<KernelCounters> all;
    for (auto& [name, counters] : by_name) {
        counters.occupancy /= counters.seconds;
        all.push_back(counters);
    }
    return all;
}

std::vector<KernelCounters> count_under_ncu(const std::string& ncu, const std::vector<std::string>& arguments,
                                            const std::vector<std::string>& kernels) {
    const fs::path log = fs::temp_directory_path() / fmt::format("ptbench-{}.ncu.csv", ::getpid());
    const fs::path image = fs::temp_directory_path() / fmt::format("ptbench-{}.pfm", ::getpid());
    std::vector<std::string> command{ncu,
                                     "--clock-control",
                                     "none",
                                     "--csv",
                                     "--page",
                                     "raw",
                                     "--print-units",
                                     "base",
                                     "--log-file",
                                     log.string(),
                                     "--metrics",
                                     fmt::format("{}", fmt::join(metrics, ",")),
                                     "-k",
                                     fmt::format("regex:^({})$", fmt::join(kernels, "|")),
                                     fs::read_symlink("/proc/self/exe").string(),
                                     "render",
                                     "--untuned"};
    command.insert(command.end(), arguments.begin(), arguments.end());
    command.insert(command.end(), {"--out", image.string()});
    const Finished finished = run(command);
    std::ostringstream csv;
    csv << std::ifstream(log).rdbuf();
    std::error_code ignored;
    fs::remove(log, ignored);
    fs::remove(image, ignored);
    if (finished.status != 0) {
        throw MachineError(fmt::format("ncu failed: {}", csv.str().empty() ? finished.output : csv.str()));
    }
    std::vector<KernelCounters> counters = parse_ncu_csv(csv.str());
    if (counters.empty()) {
        throw MachineError("ncu counted no kernel: " + csv.str());
    }
    return counters;
}

nlohmann::ordered_json counters_json(const KernelCounters& c, const Ceilings& ceilings, double rays) {
    const std::pair<const char*, double> fractions[] = {{"issue", c.instructions / c.seconds / ceilings.issue},
                                                        {"fma", c.fma / c.seconds / ceilings.fma},
                                                        {"alu", c.alu / c.seconds / ceilings.alu},
                                                        {"xu", c.xu / c.seconds / ceilings.xu},
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
            {"of_ceiling", of_ceiling},
            {"bound", bound->first}};
}

}  // namespace pt::cuda
