// The clock of a core: what contradicts itself is no clock.
#include "harness/machine/cpu_clock.h"

#include <gtest/gtest.h>

namespace pt {
namespace {

// A core at 3590 MHz whose time stamp counter runs at 2600 MHz.
constexpr ClockEvidence sound{
    .additions_per_us = 3590, .multiplications_per_us = 3590.0 / 3, .time_stamps_per_us = 2600};

TEST(CpuClockTest, OneAdditionACycleAndThreeCyclesAMultiplication) {
    EXPECT_EQ(clock_of(sound), 3590.0);
    EXPECT_EQ(clock_problem(sound), "");
}

// What a chain of `add $1` said on that core.
TEST(CpuClockTest, AFoldedChainIsNoClock) {
    ClockEvidence folded = sound;
    folded.additions_per_us = 19108;
    EXPECT_EQ(clock_of(folded), std::nullopt);
    EXPECT_EQ(clock_problem(folded), "additions say 19108 MHz, multiplications 3590 MHz");
    folded.multiplications_per_us = 19108.0 / 3;  // were they folded too
    EXPECT_EQ(clock_problem(folded), "additions say 19108 MHz, the time stamp counter runs at 2600 MHz");
    folded.time_stamps_per_us = 0;
    folded.cpufreq_max_mhz = 3800;
    EXPECT_EQ(clock_problem(folded), "additions say 19108 MHz, the kernel's highest clock is 3800 MHz");
}

TEST(CpuClockTest, BoostAndIdlingAreClocks) {
    for (const double mhz : {400.0, 1100.0, 4700.0, 5500.0}) {
        ClockEvidence evidence{mhz, mhz / 3, 1100, 2900};
        evidence.time_stamps_per_us = mhz > 5000 ? 2600 : 1100;
        EXPECT_EQ(clock_of(evidence), mhz) << clock_problem(evidence);
    }
}

TEST(CpuClockTest, WithoutAChainThereIsNone) {
    EXPECT_EQ(clock_of({}), std::nullopt);
    EXPECT_NE(clock_problem({}), "");
}

// On this machine, whatever it is: no core has run at 10 GHz.
TEST(CpuClockTest, ThisMachinesClockIsPlausibleOrUnknown) {
    const ClockEvidence evidence = measure_clock_evidence();
    if (const std::optional<double> clock = clock_of(evidence)) {
        EXPECT_GT(*clock, 100);
        EXPECT_LT(*clock, 10000);
    } else {
        EXPECT_NE(clock_problem(evidence), "");
    }
}

}  // namespace
}  // namespace pt
