// What a launcher's environment says of a process, and which GPU a rank takes.
#include <map>

#include <gtest/gtest.h>

#include "harness/ranks/launch.h"

namespace pt::test {
namespace {

using Environment = std::map<std::string, std::string>;

Launch launch_in(const Environment& environment) {
    return launch_from([&](const char* name) {
        const auto found = environment.find(name);
        return found == environment.end() ? nullptr : found->second.c_str();
    });
}

TEST(LaunchTest, ALoneProcessIsOneRank) {
    EXPECT_EQ(launch_in({}), Launch{});
    // A step of several tasks that are no MPI program, and a batch script: nothing speaks to MPI there.
    EXPECT_EQ(launch_in({{"SLURM_STEP_NUM_TASKS", "4"}, {"SLURM_PROCID", "2"}, {"SLURM_NTASKS", "4"}}), Launch{});
}

TEST(LaunchTest, TheLaunchersAreKnownByTheirVariables) {
    EXPECT_EQ(launch_in({{"OMPI_COMM_WORLD_RANK", "3"},
                         {"OMPI_COMM_WORLD_SIZE", "4"},
                         {"OMPI_COMM_WORLD_LOCAL_RANK", "1"},
                         {"OMPI_COMM_WORLD_LOCAL_SIZE", "2"}}),
              (Launch{3, 4, 1, 2}));
    EXPECT_EQ(launch_in({{"PMI_RANK", "1"}, {"PMI_SIZE", "2"}}), (Launch{1, 2, 0, 1}));
    EXPECT_EQ(launch_in({{"PMIX_RANK", "5"}, {"SLURM_STEP_NUM_TASKS", "8"}, {"SLURM_LOCALID", "1"}}),
              (Launch{5, 8, 1, 1}));
}

TEST(LaunchTest, WhatIsNoRankIsNotTaken) {
    for (const auto& [rank, count] : {std::pair("x", "4"), std::pair("1", ""), std::pair("4", "4"),
                                      std::pair("-1", "4"), std::pair("1", "4 "), std::pair("0", "0")}) {
        EXPECT_EQ(launch_in({{"PMI_RANK", rank}, {"PMI_SIZE", count}}), Launch{}) << rank << " of " << count;
    }
}

TEST(LaunchTest, RanksOfAHostHaveAGpuEach) {
    const Launch second{.rank = 5, .count = 8, .local_rank = 1, .local_count = 4};
    EXPECT_EQ(own_gpu(second, nullptr), "1");
    EXPECT_EQ(own_gpu(second, "4,5,6,7"), "5");
    EXPECT_EQ(own_gpu(second, "GPU-a,GPU-b,GPU-c,GPU-d"), "GPU-b");
    EXPECT_EQ(own_gpu(second, "3"), "") << "the launcher gave it one";
    EXPECT_EQ(own_gpu(second, ""), "");
    EXPECT_EQ(own_gpu({.rank = 1, .count = 2, .local_rank = 0, .local_count = 1}, nullptr), "");
}

}  // namespace
}  // namespace pt::test
