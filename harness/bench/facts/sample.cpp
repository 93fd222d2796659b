#include "harness/bench/facts/sample.h"

#include <algorithm>
#include <cmath>

#include "limits_of_judgement.h"  // generated from analysis/ptbench/io/limits.json

namespace pt {

namespace {

using OrderedJson = nlohmann::ordered_json;

constexpr const char* low_clock_key = "pt_low_clock";
constexpr const char* cpu_time_key = "cpu_time";

// Finds the first member of a sample that is not finite.
struct FindInfinite {
    std::string& found;

    template <class T>
    void operator()(const char* key, const T& value) const {
        if constexpr (std::is_floating_point_v<T>) {
            if (found.empty() && !std::isfinite(value)) {
                found = fmt::format("{} {}", key, describe(Json(value)));
            }
        }
    }
    template <class T>
    void operator()(const char* key, const std::optional<T>& value) const {
        if (value) {
            (*this)(key, *value);
        }
    }
    template <class T>
    void or_null(const char*, const T&) const {}
};

}  // namespace

void CheckpointFacts::set_errors(const std::optional<Errors>& errors) {
    if (errors) {
        me_rgb = errors->me_rgb;
        mse = errors->mse;
        mse_dual = errors->mse_dual;
        rel_mse = errors->rel_mse;
        rel_mse_dual = errors->rel_mse_dual;
        smape = errors->smape;
        bias2 = errors->bias2;
    }
}

Sample sample_of_result(const Json& row) {
    Sample sample;
    read_fields(row, sample, Missing::is_left_out);
    return sample;
}

Sample sample_of_row(const OrderedJson& row) {
    Sample sample = sample_of_result(Json(row));
    sample.cpu_ms = row.at(cpu_time_key);
    return sample;
}

bool is_throttled(const Sample& sample) { return sample.throttled_periods > 0; }

bool is_contended(const Sample& sample) {
    return is_throttled(sample) || sample.foreign_cpu_ms > std::max<double>(limits::most_foreign_ms,
                                                                            limits::most_foreign_share * sample.cpu_ms);
}

bool is_disturbed(const Sample& sample, Backend backend) {
    const bool was_late = 1 - sample.device_ms.value_or(0) / sample.wall_ms > limits::most_host_share;
    // Device time includes the time in which a kernel waits for an answer of a busy host.
    const bool was_waited_for = sample.host_waits > 0;
    return is_contended(sample) && (backend != Backend::cuda || was_late || was_waited_for);
}

std::optional<double> clock_of(const Sample& sample) {
    const double before = sample.clock_mhz_before.value_or(0), after = sample.clock_mhz_after.value_or(0);
    const bool is_known = before != 0 && after != 0 && sample.clock_unknown == 0;
    return is_known ? std::optional(0.5 * (before + after)) : std::nullopt;
}

double highest_clock(const Sample& sample) {
    return std::max(sample.clock_mhz_before.value_or(0), sample.clock_mhz_after.value_or(0));
}

bool has_low_clock(const Sample& sample, double highest_of_run) {
    return std::min(sample.clock_mhz_before.value_or(highest_of_run), sample.clock_mhz_after.value_or(highest_of_run)) <
           limits::low_clock_share * highest_of_run;
}

std::string fault_of_sample(const Sample& sample) {
    std::string infinite;
    Sample::fields(sample, FindInfinite{infinite});
    if (!infinite.empty()) {
        return infinite;
    }
    const double wall = sample.wall_ms;
    if (!(wall > 0)) {
        return fmt::format("pt_wall_ms {}, not above 0", wall);
    }
    if (sample.device_ms && !(*sample.device_ms > 0)) {
        return fmt::format("pt_device_ms {}, not above 0", *sample.device_ms);
    }
    if (sample.end_to_end_ms && !(*sample.end_to_end_ms > 0)) {
        return fmt::format("pt_end_to_end_ms {}, not above 0", *sample.end_to_end_ms);
    }
    if (sample.device_ms && *sample.device_ms > wall * (1 + limits::clocks_differ)) {
        return fmt::format("pt_device_ms {} above its pt_wall_ms {}", *sample.device_ms, wall);
    }
    if (sample.end_to_end_ms && *sample.end_to_end_ms < wall) {
        return fmt::format("pt_end_to_end_ms {} below its pt_wall_ms {}", *sample.end_to_end_ms, wall);
    }
    return "";
}

void add_sample_to_row(OrderedJson& row, const Sample& sample) {
    row["real_time"] = sample.wall_ms;
    row[cpu_time_key] = sample.cpu_ms;
    row["time_unit"] = "ms";
    Sample::visit_row(sample, fields_detail::Writer<OrderedJson>(row));
    row["film_hash"] = sample.film_hash;
    row[low_clock_key] = 0;  // mark_low_clocks sets this flag later, when the clocks of all rows are known
    row["pt_contended"] = is_contended(sample) ? 1 : 0;
}

bool is_row_of_sample(const OrderedJson& row) { return row.contains(low_clock_key); }

void mark_low_clocks(OrderedJson& rows) {
    std::vector<std::pair<OrderedJson*, Sample>> samples;
    double highest = 0;
    for (OrderedJson& row : rows) {
        if (is_row_of_sample(row)) {
            samples.emplace_back(&row, sample_of_result(Json(row)));
            highest = std::max(highest, highest_clock(samples.back().second));
        }
    }
    for (const auto& [row, sample] : samples) {
        (*row)[low_clock_key] = has_low_clock(sample, highest) ? 1 : 0;
    }
}

}  // namespace pt
