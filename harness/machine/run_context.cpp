#include "harness/machine/run_context.h"

#include <cmath>
#include <set>

#include <benchmark/benchmark.h>

namespace pt {

BenchmarkContext BenchmarkContext::now() {
    const benchmark::CPUInfo& cpu = benchmark::CPUInfo::Get();
    BenchmarkContext context{.host_name = benchmark::SystemInfo::Get().name,
                             .num_cpus = cpu.num_cpus,
                             .mhz_per_cpu = std::lround(cpu.cycles_per_second / 1e6),
                             .cpu_scaling_enabled = cpu.scaling == benchmark::CPUInfo::ENABLED,
                             .load_avg = cpu.load_avg};
    for (const benchmark::CPUInfo::CacheInfo& cache : cpu.caches) {
        context.caches.push_back({cache.type, cache.level, cache.size, cache.num_sharing});
    }
    return context;
}

bool is_own_of_a_shard(const std::string& context_key) {
    static const std::set<std::string> keys{CallContext::date_key,         BenchmarkContext::host_name_key,
                                            CallContext::rank_hosts_key,   BenchmarkContext::mhz_per_cpu_key,
                                            CallContext::command_line_key, BenchmarkContext::load_avg_key};
    return keys.contains(context_key);
}

}  // namespace pt
