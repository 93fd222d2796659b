// The context of result files, with all of its keys: facts about the machine, the program and the call.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "harness/fields.h"

namespace pt {

// Context keys for the GPU and the compiler of its kernels; all values are texts.
struct GpuContext {
    std::string device = {}, compute_capability = {}, multiprocessors = {}, clock_mhz = {}, memory_clock_mhz = {};
    std::string memory_bus_bits = {}, memory_mib = {}, l2_bytes = {}, ecc = {}, mps = {}, driver = {}, runtime = {};
    std::string nvrtc = {}, cccl = {}, kernel_source_hash = {};
    std::optional<std::string> devices = {}, nccl = {};  // context keys only of hosts with several equal GPUs

    template <class Self, class Visit>
    static void fields(Self& self, const Visit& visit) {
        visit("ptbench.cuda_device", self.device);
        visit("ptbench.cuda_compute_capability", self.compute_capability);
        visit("ptbench.cuda_multiprocessors", self.multiprocessors);
        visit("ptbench.cuda_clock_mhz", self.clock_mhz);
        visit("ptbench.cuda_memory_clock_mhz", self.memory_clock_mhz);
        visit("ptbench.cuda_memory_bus_bits", self.memory_bus_bits);
        visit("ptbench.cuda_memory_mib", self.memory_mib);
        visit("ptbench.cuda_l2_bytes", self.l2_bytes);
        visit("ptbench.cuda_ecc", self.ecc);
        visit("ptbench.cuda_mps", self.mps);
        visit("ptbench.cuda_driver", self.driver);
        visit("ptbench.cuda_runtime", self.runtime);
        visit("ptbench.cuda_nvrtc", self.nvrtc);
        visit("ptbench.cuda_cccl", self.cccl);
        visit("ptbench.cuda_kernel_source_hash", self.kernel_source_hash);
        visit("ptbench.cuda_devices", self.devices);
        visit("ptbench.cuda_nccl", self.nccl);
    }
};

// Context keys for the machine and the build; all values are texts.
struct MachineContext {
    std::string schema_version = "1";
    std::string version = {}, git_sha = {}, git_dirty = {}, machine = {}, cpu_model = {}, os = {};
    std::string compiler = {}, compiler_flags = {}, build_type = {}, program_hash = {}, openmp_environment = {};
    std::string clock = {};  // method of measuring the CPU clock
    std::string threads = {}, cpu_quota = {}, thrust_version = {}, thrust_system = {};
    std::string google_benchmark_version = {};
    std::optional<GpuContext> gpu = {};     // context of the GPU, only for runs on a GPU
    std::optional<std::string> ranks = {};  // number of MPI ranks, only if there are several

    template <class Self, class Visit>
    static void fields(Self& self, const Visit& visit) {
        visit("ptbench.schema_version", self.schema_version);
        visit("ptbench.version", self.version);
        visit("ptbench.git_sha", self.git_sha);
        visit("ptbench.git_dirty", self.git_dirty);
        visit("ptbench.machine", self.machine);
        visit("ptbench.cpu_model", self.cpu_model);
        visit("ptbench.os", self.os);
        visit("ptbench.compiler", self.compiler);
        visit("ptbench.compiler_flags", self.compiler_flags);
        visit("ptbench.build_type", self.build_type);
        visit("ptbench.program_hash", self.program_hash);
        visit("ptbench.openmp_environment", self.openmp_environment);
        visit("ptbench.clock", self.clock);
        visit("ptbench.threads", self.threads);
        visit("ptbench.cpu_quota", self.cpu_quota);
        visit("ptbench.thrust_version", self.thrust_version);
        visit("ptbench.thrust_system", self.thrust_system);
        visit("ptbench.google_benchmark_version", self.google_benchmark_version);
        if (self.gpu) {
            GpuContext::fields(*self.gpu, visit);
        }
        visit("ptbench.ranks", self.ranks);
    }
};

// The command that wrote the result file, and how it ended. Each kind of result file has some of these keys.
struct CallContext {
    std::optional<std::vector<std::string>> rank_hosts = {};  // host names of several MPI ranks
    std::optional<std::string> command_line = {}, suite = {}, backend = {}, status = {}, date = {};

    static constexpr const char* rank_hosts_key = "ptbench.rank_hosts";
    static constexpr const char* command_line_key = "ptbench.command_line";
    static constexpr const char* status_key = "ptbench.status";
    static constexpr const char* date_key = "date";

    template <class Self, class Visit>
    static void fields(Self& self, const Visit& visit) {
        visit(rank_hosts_key, self.rank_hosts);
        visit(command_line_key, self.command_line);
        visit("ptbench.suite", self.suite);
        visit("ptbench.backend", self.backend);
        visit(status_key, self.status);
        visit(date_key, self.date);
    }
};

// Context keys of Google Benchmark, which its tools read.
struct BenchmarkContext {
    struct Cache {
        std::string type = {};
        int level = 0, size = 0, num_sharing = 0;

        template <class Self, class Visit>
        static void fields(Self& self, const Visit& visit) {
            visit("type", self.type);
            visit("level", self.level);
            visit("size", self.size);
            visit("num_sharing", self.num_sharing);
        }
    };
    std::string date = {};  // time at the end of the run, ISO 8601
    std::string host_name = {};
    std::string executable = "ptbench";
    int num_cpus = 0;
    long mhz_per_cpu = 0;
    bool cpu_scaling_enabled = false;
    std::vector<Cache> caches = {};
    std::vector<double> load_avg = {};

    static constexpr const char* host_name_key = "host_name";
    static constexpr const char* mhz_per_cpu_key = "mhz_per_cpu";
    static constexpr const char* load_avg_key = "load_avg";

    // The context values for this machine at this moment; the field `date` is left empty.
    static BenchmarkContext now();

    template <class Self, class Visit>
    static void fields(Self& self, const Visit& visit) {
        visit(CallContext::date_key, self.date);
        visit(host_name_key, self.host_name);
        visit("executable", self.executable);
        visit("num_cpus", self.num_cpus);
        visit(mhz_per_cpu_key, self.mhz_per_cpu);
        visit("cpu_scaling_enabled", self.cpu_scaling_enabled);
        visit("caches", self.caches);
        visit(load_avg_key, self.load_avg);
    }
};

// Whether a key of a result's context belongs to a process or a moment, so that it may differ between shards of a run.
bool is_own_of_a_shard(const std::string& context_key);

}  // namespace pt
