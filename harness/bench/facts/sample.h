// A sample: a timed render of a cell and what was measured around it, in the form in which the journal and the result
// file store it. A new field needs a member and a line of `fields` here, its value in take_sample.cpp, and its meaning
// under `sample` in analysis/ptbench/schema/ptbench-result.schema.json, to which the journal's schema refers.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "harness/error/metrics.h"
#include "harness/fields.h"
#include "variants/descriptor.h"

namespace pt {

// A render's times and errors at a checkpoint. The errors are empty where the film has samples that are not finite;
// bias2 (squared bias) also where the halves of the render's samples are not known or not independent.
struct CheckpointFacts {
    std::uint32_t spp = 0;
    double wall_ms = 0, device_ms = 0, cpu_ms = 0;
    std::string film_hash = {};
    std::uint64_t nonfinite = 0;
    std::optional<std::array<double, 3>> me_rgb = {};
    std::optional<double> mse = {}, mse_dual = {}, rel_mse = {}, rel_mse_dual = {}, smape = {}, bias2 = {};
    std::optional<bool> shared = {};  // whether another cell's film has the same bits; in result files only

    void set_errors(const std::optional<Errors>& errors);

    template <class Self, class Visit>
    static void fields(Self& self, const Visit& visit) {
        visit.or_null("bias2", self.bias2);
        visit("cpu_ms", self.cpu_ms);
        visit("device_ms", self.device_ms);
        visit("film_hash", self.film_hash);
        visit.or_null("me_rgb", self.me_rgb);
        visit.or_null("mse", self.mse);
        visit.or_null("mse_dual", self.mse_dual);
        visit("nonfinite", self.nonfinite);
        visit.or_null("rel_mse", self.rel_mse);
        visit.or_null("rel_mse_dual", self.rel_mse_dual);
        visit.or_null("smape", self.smape);
        visit("spp", self.spp);
        visit("wall_ms", self.wall_ms);
        visit("shared", self.shared);
    }
    bool operator==(const CheckpointFacts&) const = default;
};

struct Sample {
    double wall_ms = 0;  // wall time of the render in ms, by which cells are compared
    double cpu_ms = 0;   // CPU time of the render in ms, all threads together
    std::optional<double> device_ms = {}, end_to_end_ms = {};
    std::uint64_t seed = 0;
    std::uint32_t spp = 0;
    std::uint64_t paths = 0, rays = 0, connections = 0, cache_hits = 0;
    double rays_per_second = 0;
    std::uint64_t launches = 0, graph_nodes = 0, loop_rounds = 0, host_waits = 0;
    std::uint64_t order = 0;  // position of the sample among all samples of the run
    double timestamp = 0;     // seconds since 1970 at the end of the sample
    int clock_unknown = 0;    // 1 if the processor's clock before or after the sample is unknown, 0 otherwise
    std::optional<double> clock_mhz_before = {}, clock_mhz_after = {};
    double foreign_cpu_ms = 0;  // CPU time of other processes during the sample; rounding can make it negative
    long involuntary_switches = 0;
    std::uint64_t throttled_periods = 0;  // scheduler periods in which a CPU quota was used up
    double throttled_ms = 0;
    std::optional<int> ranks = {};  // number of MPI ranks if there are several
    std::optional<double> slowest_rank_ms = {}, fastest_rank_ms = {}, reduce_ms = {};
    std::optional<std::uint32_t> devices = {};  // number of GPUs if there are several
    std::optional<std::vector<double>> own_device_ms = {};
    std::optional<double> slowest_device_ms = {}, device_reduce_ms = {};
    std::optional<std::vector<CheckpointFacts>> checkpoints =
        {};  // times and errors at the checkpoints of a convergence cell
    std::string film_hash = {};

    // Calls `visit` for every field of a sample. Keys with the prefix pt_ are those of a result row, in its order.
    template <class Self, class Visit>
    static void fields(Self& self, const Visit& visit) {
        visit("cpu_ms", self.cpu_ms);
        visit_row(self, visit);
        visit("film_hash", self.film_hash);
    }
    template <class Self, class Visit>
    static void visit_row(Self& self, const Visit& visit) {
        visit("pt_cache_hits", self.cache_hits);
        visit("pt_checkpoints", self.checkpoints);
        visit("pt_clock_mhz_after", self.clock_mhz_after);
        visit("pt_clock_mhz_before", self.clock_mhz_before);
        visit("pt_clock_unknown", self.clock_unknown);
        visit("pt_connections", self.connections);
        visit("pt_device_ms", self.device_ms);
        visit("pt_device_reduce_ms", self.device_reduce_ms);
        visit("pt_devices", self.devices);
        visit("pt_end_to_end_ms", self.end_to_end_ms);
        visit("pt_fastest_rank_ms", self.fastest_rank_ms);
        visit("pt_foreign_cpu_ms", self.foreign_cpu_ms);
        visit("pt_graph_nodes", self.graph_nodes);
        visit("pt_host_waits", self.host_waits);
        visit("pt_involuntary_switches", self.involuntary_switches);
        visit("pt_launches", self.launches);
        visit("pt_loop_rounds", self.loop_rounds);
        visit("pt_order", self.order);
        visit("pt_own_device_ms", self.own_device_ms);
        visit("pt_paths", self.paths);
        visit("pt_ranks", self.ranks);
        visit("pt_rays", self.rays);
        visit(rays_per_second_key, self.rays_per_second);
        visit("pt_reduce_ms", self.reduce_ms);
        visit("pt_seed", self.seed);
        visit("pt_slowest_device_ms", self.slowest_device_ms);
        visit("pt_slowest_rank_ms", self.slowest_rank_ms);
        visit("pt_spp", self.spp);
        visit("pt_throttled_ms", self.throttled_ms);
        visit("pt_throttled_periods", self.throttled_periods);
        visit("pt_timestamp", self.timestamp);
        visit("pt_wall_ms", self.wall_ms);
    }
    static constexpr const char* rays_per_second_key = "pt_rays_per_second";
    bool operator==(const Sample&) const = default;
};

// Reads a sample from a row or a retake of a result file. Fields that an older program did not write keep their
// defaults. Throws WrongFact.
Sample sample_of_result(const Json& row);
// Reads a sample from a row of a result file, with its CPU time, which rows store under another key. Throws WrongFact.
Sample sample_of_row(const nlohmann::ordered_json& row);

// Whether a CPU quota stopped the threads of a render during a sample.
bool is_throttled(const Sample& sample);
// Whether other processes disturbed a sample: they took more than a tenth of the render's own CPU time and more than
// the counter's resolution, or a CPU quota was used up.
bool is_contended(const Sample& sample);
// Whether a disturbance (another process or a CPU quota) may have falsified a sample's time. On a GPU a busy host
// matters only if the render took longer than the device worked, or if the device waited for the host during the
// render.
bool is_disturbed(const Sample& sample, Backend backend);
// The mean of the processor's clocks before and after a render, in MHz; none if one of them is unknown.
std::optional<double> clock_of(const Sample& sample);

// The higher of the processor's clocks before and after a render, in MHz; 0 if both are unknown.
double highest_clock(const Sample& sample);
// Whether the processor's clock before or after a sample was far below the highest clock of the whole run.
bool has_low_clock(const Sample& sample, double highest_of_run);

// Says why no render can have produced this sample, as text; empty if one can.
std::string fault_of_sample(const Sample& sample);

// Adds a sample's fields to a row of the result file that has only the cell's name and the sample's index so far.
void add_sample_to_row(nlohmann::ordered_json& row, const Sample& sample);
// Whether a row of a result file is a sample, and not an aggregate or a failure.
bool is_row_of_sample(const nlohmann::ordered_json& row);
// Marks the rows of samples during which the processor's clock was far below the highest clock in all rows.
void mark_low_clocks(nlohmann::ordered_json& rows);

}  // namespace pt
