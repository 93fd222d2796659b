// What Nsight Compute counted, read from its table, and the figures that are made of it. Needs neither ncu nor a GPU.
#include "harness/cuda/profile.h"

#include <gtest/gtest.h>

#include "harness/error.h"

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

// As ncu writes it: its own words first, then names, units and a line a launch.
const std::string table =
    R"csv(==PROF== Connected to process 4242 (/work/build/ptbench)
==PROF== Profiling "megakernel" - 0: 0%....50%....100% - 2 passes
"ID","Process Name","Kernel Name","dram__bytes.sum","gpu__time_duration.sum","sm__inst_executed_pipe_alu.sum","sm__inst_executed_pipe_fma.sum","sm__inst_executed_pipe_fp64.sum","sm__inst_executed_pipe_lsu.sum","sm__inst_executed_pipe_xu.sum","sm__warps_active.avg.pct_of_peak_sustained_active","smsp__inst_executed.sum","smsp__thread_inst_executed.sum"
"","","","Mbyte","us","inst","inst","inst","inst","inst","%","inst","inst"
"0","ptbench","megakernel(Scene, FilmView, unsigned int)","1.5","1,500","400","3,000","7","50","60","60","1,234,567","32,000,000"
"1","ptbench","megakernel(Scene, FilmView, unsigned int)","1,024.25","500.5","100","1,000","1","5","6","20","1,000,000","8,000,000"
"2","ptbench, ""the"" other","fill_cache(Scene)","0","2","1","2","3","4","5","100","6","7"
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
    // By their time, not each launch alike.
    EXPECT_DOUBLE_EQ(kernel.occupancy, (0.6 * 1500 + 0.2 * 500.5) / 2000.5);
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
          "sm__warps_active.avg.pct_of_peak_sustained_active"}) {
        const std::string without = with(table, "\"" + column + "\"", "\"another\"");
        EXPECT_EQ(machine_error([&] { (void)cuda::parse_ncu_csv(without); }), "ncu's table lacks the column " + column);
    }
}

TEST(NcuTableTest, ALineThatIsCutShortIsNoLaunch) {
    const std::string cut = table.substr(0, table.find(",\"7\"\n"));
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
                             .occupancy = 0.75};
constexpr cuda::Ceilings ceilings{.issue = 16e9, .fma = 4e9, .alu = 8e9, .xu = 8e9, .memory = 32e9};

TEST(CounterFiguresTest, AreThoseOfARayAndOfTheCeilings) {
    EXPECT_EQ(nlohmann::json(cuda::counters_json(counted, ceilings, 1e9)), nlohmann::json::parse(R"({
        "launches": 3, "milliseconds": 2000, "active_lanes": 20, "achieved_occupancy": 0.75,
        "warp_instructions_per_ray": 8, "thread_instructions_per_ray": 160,
        "fma_per_ray": 4, "alu_per_ray": 2, "xu_per_ray": 1, "lsu_per_ray": 0.5, "fp64_per_ray": 0.25, "memory_bytes_per_ray": 16,
        "of_ceiling": {"issue": 0.25, "fma": 0.5, "alu": 0.125, "xu": 0.0625, "memory": 0.25}, "bound": "fma"})"));
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
}

}  // namespace
}  // namespace pt
