// The clock of the core that this thread runs on, measured: chains of dependent instructions of known latency against
// the steady clock, and what shows that such a chain did not take the cycles that it should.
//
// Latencies: 1 cycle for an addition of registers, 3 for a 32-bit multiplication, on Intel's cores since Nehalem and
// AMD's since Zen (uops.info). Additions of a constant have none on recent cores, which fold them when they rename
// registers: a chain of `add $1` said 19,108 MHz on a core that ran at 3,590.
#pragma once

#include <optional>
#include <string>

namespace pt {

// Steps per microsecond of each chain, and rates that a core's clock must be near. 0: not available on this machine.
struct ClockEvidence {
    double additions_per_us = 0;
    double multiplications_per_us = 0;
    double time_stamps_per_us = 0;  // a constant rate on every core since 2008, near the nominal clock
    double cpufreq_max_mhz = 0;     // the highest that the kernel names for a core; boost may go beyond it
};

// The clock in MHz; nothing if the evidence contradicts itself.
std::optional<double> clock_of(const ClockEvidence& evidence);
// The contradiction in the evidence for the clock, in words with the numbers; empty where clock_of has a clock.
std::string clock_problem(const ClockEvidence& evidence);

// Takes about 0.5 ms, up to five times as long where the chains contradict each other: the fastest of several short
// passes of each.
ClockEvidence measure_clock_evidence();
// How the clock is measured on this kind of processor, for the context of a result.
std::string clock_method();

}  // namespace pt
