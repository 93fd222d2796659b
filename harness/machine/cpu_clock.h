// Measures the clock of the core that runs this thread, by chains of dependent instructions of known latency against
// the steady clock, and detects chains that did not take the expected cycles.
//
// Latencies: 1 cycle for an addition of registers, 3 for a 32-bit multiplication, on Intel's cores since Nehalem and
// AMD's since Zen (uops.info). Additions of a constant have no latency on recent cores, which fold them in register
// renaming: a chain of `add $1` gave 19,108 MHz on a core that ran at 3,590.
#pragma once

#include <optional>
#include <string>

namespace pt {

// Evidence for a core's clock: steps per microsecond of each instruction chain, and rates that the clock must be near.
// A value of 0 is not available on this machine.
struct ClockEvidence {
    double additions_per_us = 0;
    double multiplications_per_us = 0;
    double time_stamps_per_us = 0;  // rate of the time stamp counter: constant, near the nominal clock (since 2008)
    double cpufreq_max_mhz = 0;     // highest clock that the kernel states for the core; boost may exceed it
};

// The core's clock in MHz; nothing if the evidence contradicts itself.
std::optional<double> clock_of(const ClockEvidence& evidence);
// Describes the contradiction in the evidence for the clock, with the numbers; empty if there is none.
std::string clock_problem(const ClockEvidence& evidence);

// Measures the clock evidence as the fastest of several short passes of each chain. Takes about 0.5 ms, or up to five
// times as long if the chains contradict each other.
ClockEvidence measure_clock_evidence();
// Describes how the clock is measured on this kind of processor, for the context of a result.
std::string clock_method();

}  // namespace pt
