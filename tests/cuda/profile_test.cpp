// What Nsight Compute counted, read from its table, and the figures that are made of it. Needs neither ncu nor a GPU.
#include "harness/cuda/profile.h"

#include <filesystem>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "harness/failure.h"
#include "tests/support/command.h"

namespace pt {
namespace {

using cuda::KernelCounters;

template <class Call>
std::string machine_error(Call call) {
    try {
        call();
    } catch (const MachineError& error) {
        return error.what();
    }
    return "";
}

// A table as ncu writes it: its own words first, then names, units and a line a launch.
const std::string table =
    R"csv(==PROF== Connected to process 4242 (/work/build/ptbench)
==PROF== Profiling "megakernel" - 0: 0%....50%....100% - 2 passes
"ID","Process Name","Kernel Name","dram__bytes.sum","gpu__time_duration.sum","sm__inst_executed_pipe_alu.sum","sm__inst_executed_pipe_fma.sum","sm__inst_executed_pipe_fp64.sum","sm__inst_executed_pipe_lsu.sum","sm__inst_executed_pipe_xu.sum","sm__warps_active.avg.pct_of_peak_sustained_active","smsp__inst_executed.sum","smsp__thread_inst_executed.sum","l1tex__throughput.avg.pct_of_peak_sustained_elapsed","lts__throughput.avg.pct_of_peak_sustained_elapsed","l1tex__t_sector_hit_rate.pct","lts__t_sector_hit_rate.pct","smsp__warp_issue_stalled_long_scoreboard_per_warp_active.pct"
"","","","Mbyte","us","inst","inst","inst","inst","inst","%","inst","inst","%","%","%","%","%"
"0","ptbench","megakernel(Scene, FilmView, unsigned int)","1.5","1,500","400","3,000","7","50","60","60","1,234,567","32,000,000","50","20","90","40","70"
"1","ptbench","megakernel(Scene, FilmView, unsigned int)","1,024.25","500.5","100","1,000","1","5","6","20","1,000,000","8,000,000","30","60","80","50","10"
"2","ptbench, ""the"" other","fill_cache(Scene)","0","2","1","2","3","4","5","100","6","7","1","2","3","4","5"
==PROF== Disconnected from process 4242
)csv";

std::string with(std::string text, const std::string& what, const std::string& by) {
    const std::size_t at = text.find(what);
    return at == std::string::npos ? "" : text.replace(at, what.size(), by);
}

TEST(NcuTableTest, LaunchesOfOneKernelAreSummed) {
    const std::vector<KernelCounters> kernels = cuda::parse_ncu_csv(table);
    ASSERT_EQ(kernels.size(), 2u);
    const KernelCounters& kernel = kernels[1];
    EXPECT_EQ(kernel.name, "megakernel");
    EXPECT_EQ(kernel.launches, 2u);
    EXPECT_DOUBLE_EQ(kernel.seconds, 2000.5e-6);
    EXPECT_EQ(kernel.instructions, 2234567.0);
    EXPECT_EQ(kernel.thread_instructions, 40e6);
    EXPECT_EQ(kernel.fma, 4000.0);
    EXPECT_EQ(kernel.alu, 500.0);
    EXPECT_EQ(kernel.xu, 66.0);
    EXPECT_EQ(kernel.lsu, 55.0);
    EXPECT_EQ(kernel.fp64, 8.0);
    EXPECT_EQ(kernel.memory_bytes, 1025750000.0);
    // Launches are weighted by their time, not each launch alike.
    EXPECT_DOUBLE_EQ(kernel.occupancy, (0.6 * 1500 + 0.2 * 500.5) / 2000.5);
    EXPECT_DOUBLE_EQ(kernel.l1, (0.5 * 1500 + 0.3 * 500.5) / 2000.5);
    EXPECT_DOUBLE_EQ(kernel.l2, (0.2 * 1500 + 0.6 * 500.5) / 2000.5);
    EXPECT_DOUBLE_EQ(kernel.l1_hit_rate, (0.9 * 1500 + 0.8 * 500.5) / 2000.5);
    EXPECT_DOUBLE_EQ(kernel.l2_hit_rate, (0.4 * 1500 + 0.5 * 500.5) / 2000.5);
    EXPECT_DOUBLE_EQ(kernel.memory_stalls, (0.7 * 1500 + 0.1 * 500.5) / 2000.5);
}

TEST(NcuTableTest, KernelsAreKeptApart) {
    const std::vector<KernelCounters> kernels = cuda::parse_ncu_csv(table);
    ASSERT_EQ(kernels.size(), 2u);
    const KernelCounters& kernel = kernels[0];
    EXPECT_EQ(kernel.name, "fill_cache");
    EXPECT_EQ(kernel.launches, 1u);
    EXPECT_DOUBLE_EQ(kernel.seconds, 2e-6);
    EXPECT_EQ(kernel.instructions, 6.0);
    EXPECT_EQ(kernel.thread_instructions, 7.0);
    EXPECT_EQ(kernel.fma, 2.0);
    EXPECT_EQ(kernel.alu, 1.0);
    EXPECT_EQ(kernel.xu, 5.0);
    EXPECT_EQ(kernel.lsu, 4.0);
    EXPECT_EQ(kernel.fp64, 3.0);
    EXPECT_EQ(kernel.memory_bytes, 0.0);
    EXPECT_DOUBLE_EQ(kernel.occupancy, 1.0);
}

TEST(NcuTableTest, UnitsAreThoseThatNcuNames) {
    const std::pair<const char*, double> times[] = {{"ns", 1e-9}, {"nsecond", 1e-9}, {"us", 1e-6}, {"usecond", 1e-6},
                                                    {"ms", 1e-3}, {"msecond", 1e-3}, {"s", 1},     {"second", 1}};
    for (const auto& [unit, seconds] : times) {
        const std::vector<KernelCounters> kernels =
            cuda::parse_ncu_csv(with(table, "\"us\"", "\"" + std::string(unit) + "\""));
        ASSERT_EQ(kernels.size(), 2u) << unit;
        EXPECT_DOUBLE_EQ(kernels[1].seconds, 2000.5 * seconds) << unit;
    }
    const std::pair<const char*, double> sizes[] = {
        {"byte", 1}, {"Kbyte", 1e3}, {"Mbyte", 1e6}, {"Gbyte", 1e9}, {"Tbyte", 1e12}};
    for (const auto& [unit, bytes] : sizes) {
        const std::vector<KernelCounters> kernels =
            cuda::parse_ncu_csv(with(table, "\"Mbyte\"", "\"" + std::string(unit) + "\""));
        ASSERT_EQ(kernels.size(), 2u) << unit;
        EXPECT_DOUBLE_EQ(kernels[1].memory_bytes, 1025.75 * bytes) << unit;
    }
}

TEST(NcuTableTest, AMissingColumnIsNamed) {
    for (const std::string column :
         {"Kernel Name", "gpu__time_duration.sum", "smsp__inst_executed.sum", "smsp__thread_inst_executed.sum",
          "sm__inst_executed_pipe_fma.sum", "sm__inst_executed_pipe_alu.sum", "sm__inst_executed_pipe_xu.sum",
          "sm__inst_executed_pipe_lsu.sum", "sm__inst_executed_pipe_fp64.sum", "dram__bytes.sum",
          "sm__warps_active.avg.pct_of_peak_sustained_active", "l1tex__throughput.avg.pct_of_peak_sustained_elapsed",
          "lts__throughput.avg.pct_of_peak_sustained_elapsed", "l1tex__t_sector_hit_rate.pct",
          "lts__t_sector_hit_rate.pct", "smsp__warp_issue_stalled_long_scoreboard_per_warp_active.pct"}) {
        const std::string without = with(table, "\"" + column + "\"", "\"another\"");
        EXPECT_EQ(machine_error([&] { (void)cuda::parse_ncu_csv(without); }), "ncu's table lacks the column " + column);
    }
}

TEST(NcuTableTest, ALineThatIsCutShortIsNoLaunch) {
    const std::string cut = table.substr(0, table.find(",\"5\"\n==PROF=="));
    EXPECT_NE(machine_error([&] { (void)cuda::parse_ncu_csv(cut); }), "");
}

TEST(NcuTableTest, WithoutALaunchThereIsNoKernel) {
    EXPECT_TRUE(cuda::parse_ncu_csv("").empty());
    EXPECT_TRUE(cuda::parse_ncu_csv("==PROF== Connected\n==WARNING== No kernels were profiled.\n").empty());
    EXPECT_TRUE(cuda::parse_ncu_csv(table.substr(0, table.find("\"0\",\"ptbench\""))).empty());
}

// --- figures
// ----------------------------------------------------------------------------------------------------------

const KernelCounters counted{.name = "megakernel",
                             .launches = 3,
                             .seconds = 2,
                             .instructions = 8e9,
                             .thread_instructions = 160e9,
                             .fma = 4e9,
                             .alu = 2e9,
                             .xu = 1e9,
                             .lsu = 0.5e9,
                             .fp64 = 0.25e9,
                             .memory_bytes = 16e9,
                             .occupancy = 0.75,
                             .l1 = 0.375,
                             .l2 = 0.0625,
                             .l1_hit_rate = 0.875,
                             .l2_hit_rate = 0.5,
                             .memory_stalls = 0.625};
constexpr cuda::Ceilings ceilings{.issue = 16e9, .fma = 4e9, .alu = 8e9, .xu = 8e9, .memory = 32e9};

TEST(CounterFiguresTest, AreThoseOfARayAndOfTheCeilings) {
    EXPECT_EQ(nlohmann::json(cuda::counters_json(counted, ceilings, 1e9)), nlohmann::json::parse(R"({
        "launches": 3, "milliseconds": 2000, "active_lanes": 20, "achieved_occupancy": 0.75,
        "l1_hit_rate": 0.875, "l2_hit_rate": 0.5, "memory_stalls": 0.625,
        "warp_instructions_per_ray": 8, "thread_instructions_per_ray": 160,
        "fma_per_ray": 4, "alu_per_ray": 2, "xu_per_ray": 1, "lsu_per_ray": 0.5, "fp64_per_ray": 0.25, "memory_bytes_per_ray": 16,
        "of_ceiling": {"issue": 0.25, "fma": 0.5, "alu": 0.125, "xu": 0.0625, "l1": 0.375, "l2": 0.0625, "memory": 0.25}, "bound": "fma"})"));
}

TEST(CounterFiguresTest, TheBoundIsWhatIsNearestToItsCeiling) {
    const std::pair<const char*, double cuda::Ceilings::*> all[] = {{"issue", &cuda::Ceilings::issue},
                                                                    {"fma", &cuda::Ceilings::fma},
                                                                    {"alu", &cuda::Ceilings::alu},
                                                                    {"xu", &cuda::Ceilings::xu},
                                                                    {"memory", &cuda::Ceilings::memory}};
    for (const auto& [name, ceiling] : all) {
        cuda::Ceilings lower = ceilings;
        lower.*ceiling /= 16;
        EXPECT_EQ(cuda::counters_json(counted, lower, 1e9)["bound"], name);
    }
    for (const auto& [name, cache] : {std::pair{"l1", &KernelCounters::l1}, std::pair{"l2", &KernelCounters::l2}}) {
        KernelCounters busy = counted;
        busy.*cache = 0.9375;
        EXPECT_EQ(cuda::counters_json(busy, ceilings, 1e9)["bound"], name);
    }
}

// --- calls of ncu
// ----------------------------------------------------------------------------------------------------

// In ncu's place: keeps its arguments, a line each, and writes `written` where --log-file says.
std::string fake_ncu(const test::TemporaryFolder& folder, const std::string& written, int exit_code = 0) {
    const std::string program = folder.file("ncu");
    test::write_text(folder.file("table.csv"), written);
    test::write_text(program, fmt::format(R"sh(#!/bin/sh
for word in "$@"; do echo "$word"; done > '{0}'
while [ "$1" != --log-file ]; do shift; done
cat '{1}' > "$2"
exit {2}
)sh",
                                          folder.file("arguments"), folder.file("table.csv"), exit_code));
    std::filesystem::permissions(program, std::filesystem::perms::owner_all);
    return program;
}

TEST(NcuCallTest, BatchesAreCountedBetweenSwitchesWithWarmCaches) {
    const test::TemporaryFolder folder;
    const std::vector<KernelCounters> launches =
        cuda::count_launches_under_ncu(fake_ncu(folder, table), {"--mesh", "tori_4M"});
    EXPECT_EQ(launches.size(), 3u);
    const std::string call = test::content_of(folder.file("arguments"));
    for (const char* words :
         {"--profile-from-start\noff\n", "--cache-control\nnone\n", "--clock-control\nnone\n",
          "l1tex__throughput.avg.pct_of_peak_sustained_elapsed", "rays\n--counted\n--mesh\ntori_4M\n"}) {
        EXPECT_NE(call.find(words), std::string::npos) << words << call;
    }
}

TEST(NcuCallTest, RendersAreCountedByKernel) {
    const test::TemporaryFolder folder;
    const std::vector<KernelCounters> kernels =
        cuda::count_under_ncu(fake_ncu(folder, table), {"--scene", "cornell_open"}, {"megakernel", "fill_cache"});
    EXPECT_EQ(kernels.size(), 2u);
    const std::string call = test::content_of(folder.file("arguments"));
    EXPECT_NE(call.find("-k\nregex:^(megakernel|fill_cache)$\n"), std::string::npos) << call;
    EXPECT_NE(call.find("render\n--untuned\n--scene\ncornell_open\n--out\n"), std::string::npos) << call;
    EXPECT_EQ(call.find("--profile-from-start"), std::string::npos) << call;
}

TEST(NcuCallTest, WhatNcuSaysOfAFailureIsTold) {
    const test::TemporaryFolder folder;
    EXPECT_EQ(machine_error(
                  [&] { (void)cuda::count_launches_under_ncu(fake_ncu(folder, "==ERROR== ERR_NVGPUCTRPERM", 1), {}); }),
              "ncu failed: ==ERROR== ERR_NVGPUCTRPERM");
    EXPECT_EQ(machine_error([&] { (void)cuda::count_launches_under_ncu(fake_ncu(folder, "==PROF== Connected"), {}); }),
              "ncu counted no kernel: ==PROF== Connected");
}

// --- batches of rays
// --------------------------------------------------------------------------------------------------

TEST(BatchCountersTest, LaunchesAreTakenInTheirOrder) {
    const std::vector<KernelCounters> launches = cuda::parse_ncu_launches(table);
    ASSERT_EQ(launches.size(), 3u);
    EXPECT_EQ(launches[0].instructions, 1234567.0);
    EXPECT_EQ(launches[1].instructions, 1000000.0);
    EXPECT_DOUBLE_EQ(launches[1].memory_stalls, 0.1);
    const auto figures =
        cuda::batch_counters_json(launches, {{"megakernel", 1e6}, {"megakernel", 2e6}, {"fill_cache", 2}}, ceilings);
    ASSERT_EQ(figures.size(), 3u);
    EXPECT_DOUBLE_EQ(figures[0]["warp_instructions_per_ray"], 1.234567);
    EXPECT_DOUBLE_EQ(figures[1]["warp_instructions_per_ray"], 0.5);
    EXPECT_DOUBLE_EQ(figures[1]["active_lanes"], 8.0);
    EXPECT_DOUBLE_EQ(figures[2]["warp_instructions_per_ray"], 3.0);
}

TEST(BatchCountersTest, OtherLaunchesThanTheBatchesAreRefused) {
    const std::vector<KernelCounters> launches = cuda::parse_ncu_launches(table);
    const auto refusal = [&](const std::vector<cuda::CountedBatch>& batches) {
        return machine_error([&] { (void)cuda::batch_counters_json(launches, batches, ceilings); });
    };
    EXPECT_EQ(refusal({{"megakernel", 1}, {"megakernel", 1}}),
              "ncu counted fill_cache, where batch 3 of 2 was to come");
    EXPECT_EQ(refusal({{"megakernel", 1}, {"fill_cache", 1}, {"megakernel", 1}}),
              "ncu counted megakernel, where batch 2 of 3 was to come");
    EXPECT_EQ(refusal({{"megakernel", 1}, {"megakernel", 1}, {"fill_cache", 1}, {"fill_cache", 1}}),
              "ncu counted 3 of 4 batches");
}

}  // namespace
}  // namespace pt
