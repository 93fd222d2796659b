#include "harness/machine/cpu_quota.h"

#include <algorithm>
#include <fstream>
#include <sstream>

#include <fmt/format.h>
#include <sched.h>

#include "harness/counted.h"
#include "harness/say.h"
#include "variants/cpu/parallel_for.h"

namespace pt {

namespace {

// A line of proc/self/mountinfo on control groups: the folder `root` of their tree is mounted at `point`.
struct GroupMount {
    std::string root, point;
    bool is_version_2 = false;
};

bool has_word(const std::string& list, const std::string& word) {
    return ("," + list + ",").find("," + word + ",") != std::string::npos;
}

// Finds the mount points of the control groups that limit CPU time.
std::vector<GroupMount> group_mounts(const std::string& root) {
    std::vector<GroupMount> mounts;
    std::ifstream lines(root + "proc/self/mountinfo");
    for (std::string line; std::getline(lines, line);) {
        std::istringstream words(line);
        std::string skipped, type, options;
        GroupMount mount;
        words >> skipped >> skipped >> skipped >> mount.root >> mount.point;
        while (words >> skipped && skipped != "-") {
        }
        words >> type >> skipped >> options;
        mount.is_version_2 = type == "cgroup2";
        if (mount.is_version_2 || (type == "cgroup" && has_word(options, "cpu"))) {
            mounts.push_back(mount);
        }
    }
    return mounts;
}

// The path of the process's control group: from "0::/path" in version 2, from "4:cpu,cpuacct:/path" in version 1.
std::string group_of(const std::string& root, bool is_version_2) {
    std::ifstream lines(root + "proc/self/cgroup");
    for (std::string line; std::getline(lines, line);) {
        const std::size_t first = line.find(':'), second = line.find(':', first + 1);
        if (second == std::string::npos) {
            continue;
        }
        const std::string controllers = line.substr(first + 1, second - first - 1);
        if (is_version_2 ? controllers.empty() : has_word(controllers, "cpu")) {
            return line.substr(second + 1);
        }
    }
    return "";
}

// Adds the folder of a control group and its parents up to the mount point. Within a container the group's path may be
// the host's; then only the mount point is visible.
void add_folders(std::vector<std::string>& folders, const std::string& root, const GroupMount& mount) {
    const std::string group = group_of(root, mount.is_version_2);
    const std::string above = mount.root == "/" ? "" : mount.root;
    std::string below = group.starts_with(above + "/") ? group.substr(above.size()) : "";
    const std::string point = root + mount.point.substr(mount.point.starts_with("/") ? 1 : 0);
    while (!below.empty() && below != "/") {
        folders.push_back(point + below);
        below.erase(below.rfind('/'));
    }
    folders.push_back(point);
}

// The number of CPUs that a control group's own quota allows; nothing if it has none.
std::optional<double> quota_of(const std::string& folder) {
    double quota = 0, period = 0;
    if (std::ifstream file(folder + "/cpu.max"); file) {
        file >> quota >> period;  // cpu.max has "max 100000" if there is no quota
    } else {
        std::ifstream(folder + "/cpu.cfs_quota_us") >> quota;  // cpu.cfs_quota_us has -1 if there is no quota
        std::ifstream(folder + "/cpu.cfs_period_us") >> period;
    }
    return quota > 0 && period > 0 ? std::optional(quota / period) : std::nullopt;
}

Throttling throttling_of(const std::string& folder) {
    Throttling found;
    std::ifstream lines(folder + "/cpu.stat");
    std::string name;
    for (double value = 0; lines >> name >> value;) {
        if (name == "nr_throttled") {
            found.periods = static_cast<std::uint64_t>(value);
        } else if (name == "throttled_usec") {  // throttled time in cgroup version 2, microseconds
            found.ms = 1e-3 * value;
        } else if (name == "throttled_time") {  // throttled time in cgroup version 1, nanoseconds
            found.ms = 1e-6 * value;
        }
    }
    return found;
}

std::string counted_cpus(double cpus) { return fmt::format("{:.4g} CPU{}", cpus, cpus == 1 ? "" : "s"); }

}  // namespace

CpuGroups CpuGroups::of_this_process(const std::string& root) {
    CpuGroups groups;
    for (const GroupMount& mount : group_mounts(root)) {
        add_folders(groups.folders_, root, mount);
    }
    return groups;
}

std::optional<double> CpuGroups::quota() const {
    std::optional<double> tightest;
    for (const std::string& folder : folders_) {
        if (const std::optional<double> quota = quota_of(folder); quota && (!tightest || *quota < *tightest)) {
            tightest = quota;
        }
    }
    return tightest;
}

Throttling CpuGroups::throttling() const {
    Throttling all;
    for (const std::string& folder : folders_) {
        const Throttling found = throttling_of(folder);
        all.periods += found.periods;
        all.ms += found.ms;
    }
    return all;
}

std::string quota_in_words(std::optional<double> quota) { return quota ? fmt::format("{:.4g}", *quota) : "none"; }

int available_processors() {
    cpu_set_t set;
    CPU_ZERO(&set);
    return ::sched_getaffinity(0, sizeof set, &set) == 0 ? CPU_COUNT(&set) : 1024;
}

std::vector<std::string> cpu_warnings(int threads, int processors, std::optional<double> quota) {
    std::vector<std::string> lines;
    if (quota) {
        lines.push_back(
            fmt::format("this process has a quota of {} (control group): samples during which it was used "
                        "up are disturbed",
                        counted_cpus(*quota)));
    }
    if (quota && threads > *quota) {
        const int fitting = std::max(1, static_cast<int>(*quota));
        lines.push_back(fmt::format("warning: {} on a quota of {}: set OMP_NUM_THREADS={}",
                                    counted(static_cast<std::size_t>(threads), "thread"), counted_cpus(*quota),
                                    fitting));
    } else if (threads > processors) {
        lines.push_back(fmt::format("warning: {} on {} take turns, and times are longer for it: set OMP_NUM_THREADS={}",
                                    counted(static_cast<std::size_t>(threads), "thread"),
                                    counted(static_cast<std::size_t>(processors), "processor"), processors));
    }
    return lines;
}

void say_cpu_warnings(Backend backend) {
    const int threads = backend == Backend::cpu ? parallel_threads() : 0;
    for (const std::string& line :
         cpu_warnings(threads, available_processors(), CpuGroups::of_this_process().quota())) {
        say("ptbench: {}\n", line);
    }
}

}  // namespace pt
