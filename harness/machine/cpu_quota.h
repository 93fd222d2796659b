// The CPU time that control groups allow this process: containers and batch systems share a machine by quotas. Threads
// that have used up theirs stand still for the rest of each period, which no other process's load tells of.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "variants/descriptor.h"

namespace pt {

// How often threads were made to stand still, since the groups were made.
struct Throttling {
    std::uint64_t periods = 0;
    double ms = 0;  // of the processors that they would have had, added up

    Throttling operator-(const Throttling& before) const { return {periods - before.periods, ms - before.ms}; }
};

// The groups that a process is in, the innermost first: of version 2 (cpu.max) or 1 (cpu.cfs_quota_us).
class CpuGroups {
public:
    // The control groups of this process. `root`: the folder in which its proc/self and the groups' mount points lie.
    static CpuGroups of_this_process(const std::string& root = "/");

    // The CPUs that the tightest quota allows, 0.5 for half of one; nothing where there is no quota.
    std::optional<double> quota() const;
    // The throttling of all groups that have a quota, added up.
    Throttling throttling() const;

private:
    std::vector<std::string> folders_;
};

// The quota for the context's ptbench.cpu_quota: "1.5", or "none".
std::string quota_in_words(std::optional<double> quota);

// The number of processors that the process's threads may run on (taskset, cpusets).
int available_processors();

// What a run says first of the machine's share that it has, a line each; empty: nothing is amiss. `threads`: those of a
// render on the CPU, or 0 where the renders are not there.
std::vector<std::string> cpu_warnings(int threads, int processors, std::optional<double> quota);
// Says on stderr what limits the processors of this process.
void say_cpu_warnings(Backend backend);

}  // namespace pt
