// Quotas of CPU time, read from made folders of control groups.
#include "harness/machine/cpu_quota.h"

#include <filesystem>

#include <gtest/gtest.h>

#include "tests/support/command.h"

namespace pt {
namespace {

// A machine's files, by their paths without the first "/".
class Machine {
public:
    void write(const std::string& path, const std::string& text) {
        std::filesystem::create_directories(folder_.path() / std::filesystem::path(path).parent_path());
        test::write_text(folder_.file(path), text);
    }
    CpuGroups groups() const { return CpuGroups::of_this_process(folder_.path().string() + "/"); }

private:
    test::TemporaryFolder folder_;
};

const std::string proc_mount = "22 28 0:21 / /proc rw,nosuid shared:13 - proc proc rw\n";

void make_version_2(Machine& machine, const std::string& group, const std::string& mount_root = "/") {
    machine.write("proc/self/cgroup", "0::" + group + "\n");
    machine.write("proc/self/mountinfo", proc_mount + "32 24 0:27 " + mount_root +
                                             " /sys/fs/cgroup rw,nosuid shared:9 - cgroup2 cgroup2 rw,nsdelegate\n");
}

TEST(CpuQuotaTest, OfVersion2) {
    Machine machine;
    make_version_2(machine, "/batch/job");
    machine.write("sys/fs/cgroup/batch/job/cpu.max", "150000 100000\n");
    machine.write("sys/fs/cgroup/batch/job/cpu.stat",
                  "usage_usec 5000\nnr_periods 24\nnr_throttled 22\nthrottled_usec 1234567\n");
    const CpuGroups groups = machine.groups();
    EXPECT_EQ(groups.quota(), 1.5);
    EXPECT_EQ(groups.throttling().periods, 22u);
    EXPECT_DOUBLE_EQ(groups.throttling().ms, 1234.567);
    const Throttling before = groups.throttling();
    machine.write("sys/fs/cgroup/batch/job/cpu.stat", "nr_periods 25\nnr_throttled 23\nthrottled_usec 1234667\n");
    const Throttling during = groups.throttling() - before;
    EXPECT_EQ(during.periods, 1u);
    EXPECT_NEAR(during.ms, 0.1, 1e-9);
}

TEST(CpuQuotaTest, OfVersion1) {
    Machine machine;
    machine.write("proc/self/cgroup", "7:memory:/else\n4:cpu,cpuacct:/docker/abc\n0::/\n");
    machine.write("proc/self/mountinfo", proc_mount +
                                             "40 30 0:33 / /sys/fs/cgroup/cpuset rw - cgroup cgroup rw,cpuset\n"
                                             "41 30 0:34 / /sys/fs/cgroup/cpu rw - cgroup cgroup rw,cpu,cpuacct\n");
    machine.write("sys/fs/cgroup/cpu/docker/abc/cpu.cfs_quota_us", "60000\n");
    machine.write("sys/fs/cgroup/cpu/docker/abc/cpu.cfs_period_us", "100000\n");
    machine.write("sys/fs/cgroup/cpu/docker/abc/cpu.stat", "nr_periods 17\nnr_throttled 16\nthrottled_time 2500000\n");
    machine.write("sys/fs/cgroup/cpu/cpu.cfs_quota_us", "-1\n");
    machine.write("sys/fs/cgroup/cpu/cpu.cfs_period_us", "100000\n");
    EXPECT_EQ(machine.groups().quota(), 0.6);
    EXPECT_EQ(machine.groups().throttling().periods, 16u);
    EXPECT_DOUBLE_EQ(machine.groups().throttling().ms, 2.5);
}

// A group has no more than those above it.
TEST(CpuQuotaTest, TheTightestOfAllGroupsCounts) {
    Machine machine;
    make_version_2(machine, "/batch/job");
    machine.write("sys/fs/cgroup/batch/job/cpu.max", "max 100000\n");
    EXPECT_EQ(machine.groups().quota(), std::nullopt);
    machine.write("sys/fs/cgroup/batch/cpu.max", "200000 100000\n");
    EXPECT_EQ(machine.groups().quota(), 2);
    machine.write("sys/fs/cgroup/batch/cpu.stat", "nr_throttled 3\nthrottled_usec 1000\n");
    machine.write("sys/fs/cgroup/batch/job/cpu.stat", "nr_throttled 0\nthrottled_usec 0\n");
    EXPECT_EQ(machine.groups().throttling().periods, 3u);
    machine.write("sys/fs/cgroup/batch/job/cpu.max", "50000 100000\n");
    EXPECT_EQ(machine.groups().quota(), 0.5);
}

// In a container the mount point is the container's own group, whatever path the host gives it.
TEST(CpuQuotaTest, InAContainerTheMountPointIsTheGroup) {
    for (const auto& [group, mount_root] :
         {std::pair{"/", "/"}, std::pair{"/docker/abc", "/docker/abc"}, std::pair{"/docker/abc/inner", "/docker/abc"},
          std::pair{"/../../other", "/docker/abc"}}) {
        Machine machine;
        make_version_2(machine, group, mount_root);
        machine.write("sys/fs/cgroup/cpu.max", "300000 100000\n");
        EXPECT_EQ(machine.groups().quota(), 3) << group;
    }
}

TEST(CpuQuotaTest, WithoutGroupsThereIsNone) {
    const Machine machine;
    EXPECT_EQ(machine.groups().quota(), std::nullopt);
    EXPECT_EQ(machine.groups().throttling().periods, 0u);
    EXPECT_EQ(quota_in_words(std::nullopt), "none");
    EXPECT_EQ(quota_in_words(1.5), "1.5");
}

TEST(CpuQuotaTest, WarningsNameWhatToSet) {
    using Lines = std::vector<std::string>;
    EXPECT_EQ(cpu_warnings(2, 2, std::nullopt), Lines());
    EXPECT_EQ(cpu_warnings(64, 2, std::nullopt),
              Lines({"warning: 64 threads on 2 processors take turns, and times are longer for it: set "
                     "OMP_NUM_THREADS=2"}));
    const std::string quota =
        "this process has a quota of 1.5 CPUs (control group): samples during which it was used "
        "up are disturbed";
    EXPECT_EQ(cpu_warnings(1, 2, 1.5), Lines({quota}));
    EXPECT_EQ(cpu_warnings(0, 2, 1.5), Lines({quota}));
    EXPECT_EQ(cpu_warnings(2, 2, 1.5),
              Lines({quota, "warning: 2 threads on a quota of 1.5 CPUs: set OMP_NUM_THREADS=1"}));
    EXPECT_EQ(cpu_warnings(1, 2, 0.6).back(), "warning: 1 thread on a quota of 0.6 CPUs: set OMP_NUM_THREADS=1");
}

}  // namespace
}  // namespace pt
