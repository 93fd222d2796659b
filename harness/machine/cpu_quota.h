// The CPU time that control groups (cgroups) allow this process, as containers and batch systems limit it. Threads that
// have used up their quota are stopped for the rest of each period, which the load of other processes does not show.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "variants/descriptor.h"

namespace pt {

// How often, and for how long, control groups have stopped the process's threads since the groups were created.
struct Throttling {
    std::uint64_t periods = 0;
    double ms = 0;  // CPU time lost while threads were stopped, summed over processors

    Throttling operator-(const Throttling& before) const { return {periods - before.periods, ms - before.ms}; }
};

// The control groups of a process, the innermost first: of version 2 (cpu.max) or 1 (cpu.cfs_quota_us).
class CpuGroups {
public:
    // Finds this process's control groups. `root`: the folder that contains proc/self and the groups' mount points.
    static CpuGroups of_this_process(const std::string& root = "/");

    // The number of CPUs that the tightest quota allows (0.5 for half of one); nothing if there is no quota.
    std::optional<double> quota() const;
    // The throttling of this process by all control groups that have a quota, added up.
    Throttling throttling() const;

private:
    std::vector<std::string> folders_;
};

// The CPU quota as text for the context's key ptbench.cpu_quota: "1.5", or "none".
std::string quota_in_words(std::optional<double> quota);

// The number of processors on which this process may run (taskset, cpusets).
int available_processors();

// Warnings at the start of a run about limits on this process's CPU time, one line each; empty if there are none.
// `threads`: those of a render on the CPU, or 0 if renders are on a GPU.
std::vector<std::string> cpu_warnings(int threads, int processors, std::optional<double> quota);
// Prints on stderr the warnings about limits on this process's CPU time.
void say_cpu_warnings(Backend backend);

}  // namespace pt
