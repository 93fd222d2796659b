#include "harness/bench/result_file.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include "harness/bench/convergence_study.h"
#include "harness/bench/film_ledger.h"
#include "harness/bench/result_check.h"
#include "harness/bench/retakes.h"
#include "harness/counted.h"
#include "harness/machine/machine.h"
#include "harness/ranks/machine_json.h"
#include "harness/ranks/ranks.h"
#include "harness/scene/places.h"
#include "harness/variant_json.h"
#include "variants/variant_name.h"

namespace pt {

namespace {

using OrderedJson = nlohmann::ordered_json;

OrderedJson context(const RunFacts& facts) {
    const benchmark::CPUInfo& cpu = benchmark::CPUInfo::Get();
    OrderedJson json;
    json["date"] = facts.date;
    json["host_name"] = benchmark::SystemInfo::Get().name;
    json["executable"] = "ptbench";
    json["num_cpus"] = cpu.num_cpus;
    json["mhz_per_cpu"] = std::lround(cpu.cycles_per_second / 1e6);
    json["cpu_scaling_enabled"] = cpu.scaling == benchmark::CPUInfo::ENABLED;
    json["caches"] = OrderedJson::array();
    for (const benchmark::CPUInfo::CacheInfo& cache : cpu.caches) {
        json["caches"].push_back(
            {{"type", cache.type}, {"level", cache.level}, {"size", cache.size}, {"num_sharing", cache.num_sharing}});
    }
    json["load_avg"] = cpu.load_avg;
    json.update(machine_json(facts.backend));
    if (ranks().count > 1) {
        json["ptbench.rank_hosts"] = ranks().hosts;
    }
    json["ptbench.command_line"] = facts.command_line;
    json["ptbench.suite"] = facts.suite;
    json["ptbench.backend"] = to_string(facts.backend);
    json["ptbench.status"] = facts.completed ? "completed" : "interrupted";
    return json;
}

OrderedJson row_head(const std::string& cell, const std::string& suffix, std::size_t family, int repetitions) {
    return {{"name", cell + suffix},
            {"family_index", family},
            {"per_family_instance_index", 0},
            {"run_name", cell},
            {"run_type", suffix.empty() ? "iteration" : "aggregate"},
            {"repetitions", repetitions}};
}

// Whether other processes disturbed a sample: one took more than a tenth of the render's own CPU time, and more than
// the counter's resolution, or the system gave less of it than there was.
bool is_contended(const Json& sample) {
    return is_throttled(sample) ||
           sample.value("pt_foreign_cpu_ms", 0.0) > std::max(20.0, 0.1 * sample.value("cpu_ms", 0.0));
}

OrderedJson sample_row(const std::string& cell, std::size_t family, int repetitions, std::size_t index,
                       const Json& sample) {
    OrderedJson row = row_head(cell, "", family, repetitions);
    row["repetition_index"] = index;
    row["threads"] = 1;
    row["iterations"] = 1;
    row["real_time"] = sample.at("pt_wall_ms");
    row["cpu_time"] = sample.at("cpu_ms");
    row["time_unit"] = "ms";
    for (const auto& [key, value] : sample.items()) {
        if (key.starts_with("pt_")) {
            row[key] = value;
        }
    }
    row["film_hash"] = sample.at("film_hash");
    row["pt_low_clock"] = 0;  // by mark_low_clocks, when all are known
    row["pt_contended"] = is_contended(sample) ? 1 : 0;
    return row;
}

void add_aggregate_rows(OrderedJson& rows, const std::string& cell, std::size_t family, int repetitions,
                        const std::vector<Json>& samples) {
    std::vector<double> wall, cpu;
    for (const Json& sample : samples) {
        wall.push_back(sample.at("pt_wall_ms"));
        cpu.push_back(sample.at("cpu_ms"));
    }
    const Aggregates a = aggregate(wall);
    const Aggregates b = aggregate(cpu);
    const auto add = [&](const std::string& name, double real, double cpu_time, const char* unit) {
        OrderedJson row = row_head(cell, "_" + name, family, repetitions);
        row["threads"] = 1;
        row["aggregate_name"] = name;
        row["aggregate_unit"] = unit;
        row["iterations"] = samples.size();
        row["real_time"] = real;
        row["cpu_time"] = cpu_time;
        row["time_unit"] = "ms";
        rows.push_back(std::move(row));
    };
    add("mean", a.mean, b.mean, "time");
    add("median", a.median, b.median, "time");
    add("stddev", a.stddev, b.stddev, "time");
    add("cv", a.cv, b.cv, "percentage");
}

OrderedJson failed_row(const std::string& cell, std::size_t family, int repetitions, const std::string& reason) {
    OrderedJson row = row_head(cell, "", family, repetitions);
    row["repetition_index"] = 0;
    row["threads"] = 1;
    row["error_occurred"] = true;
    row["error_message"] = reason;
    row["iterations"] = 0;
    row["real_time"] = 0.0;
    row["cpu_time"] = 0.0;
    row["time_unit"] = "ms";
    return row;
}

// Every tunable of the cell's choices with the value that it had.
OrderedJson tunables_json(const Cell& cell) {
    OrderedJson json = OrderedJson::object();
    for (const Tunable& t : tunables_of(cell.variant, cell.backend)) {
        json[std::string(t.name)] = tunable(cell.variant, t.name, cell.backend);
    }
    return json;
}

OrderedJson cell_json(const Cell& cell, const Journal& journal, int repetitions) {
    const FeatureSet features = features_of(*cell.scene);
    OrderedJson json{{"cell", cell.name},
                     {"studies", cell.studies},
                     {"scene", cell.scene->name},
                     {"scene_hash", cell.scene->hash},
                     {"backend", to_string(cell.backend)},
                     {"variant", shown_name(cell.variant, cell.backend)},
                     {"variant_id", variant_id(cell.variant, cell.backend)},
                     {"axes", axes_json(cell.variant)},
                     {"tunables", tunables_json(cell)},
                     {"resolution", {cell.settings.width, cell.settings.height}},
                     {"depth", cell.settings.depth},
                     {"spp", cell.spp},
                     {"claim", to_string(claim_of(cell.variant, cell.backend))},
                     {"features", feature_names(features)}};
    if (!cell.scene->file.empty() && !is_shipped(*cell.scene)) {
        json["scene_file"] = cell.scene->file;
    }
    const Json* facts = journal.cell(cell.name);
    if (facts == nullptr) {
        json["status"] = "interrupted";
        json["reason"] = "the run ended before this cell was reached";
        return json;
    }
    json.update(OrderedJson(*facts));
    if (json.value("status", "") == "ok" && static_cast<int>(journal.samples(cell.name).size()) < repetitions) {
        json["status"] = "interrupted";
        json["reason"] = "the run ended before this cell had all its samples";
    }
    return json;
}

}  // namespace

Aggregates aggregate(std::vector<double> values) {
    const auto n = static_cast<double>(values.size());
    const double mean = std::accumulate(values.begin(), values.end(), 0.0) / n;
    double squares = 0;
    for (const double value : values) {
        squares += (value - mean) * (value - mean);
    }
    std::sort(values.begin(), values.end());
    const std::size_t middle = values.size() / 2;
    const double median = values.size() % 2 != 0 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
    const double stddev = values.size() > 1 ? std::sqrt(squares / (n - 1)) : 0;
    return {mean, median, stddev, mean > 0 ? stddev / mean : 0};
}

namespace {

// Films with the same bits have the same errors: which cell's they are. A sample's owner is the first cell of the plan
// that has its films, seed by seed.
class SharedErrors {
public:
    SharedErrors(const Plan& plan, const Journal& journal) {
        for (const Cell& cell : plan.cells) {
            for (const Json& sample : journal.samples(cell.name)) {
                if (cell.convergence) {
                    owners_.try_emplace(key(journal, cell, sample), cell.name);
                }
            }
        }
    }

    void mark(const Journal& journal, const Cell& cell, const Json& sample, OrderedJson& row) const {
        const bool shared = owner(journal, cell, sample) != cell.name;
        for (OrderedJson& checkpoint : row["pt_checkpoints"]) {
            checkpoint["shared"] = shared;
        }
    }
    // The cell whose errors all samples have; empty: they are its own, or several cells'.
    std::string shared_with(const Journal& journal, const Cell& cell) const {
        std::set<std::string> names;
        for (const Json& sample : journal.samples(cell.name)) {
            names.insert(owner(journal, cell, sample));
        }
        return names.size() == 1 && *names.begin() != cell.name ? *names.begin() : "";
    }

private:
    static std::string key(const Journal& journal, const Cell& cell, const Json& sample) {
        std::string text = journal.cell(cell.name)->at("convergence").at("reference").at("hash");
        for (const Json& checkpoint : sample.at("pt_checkpoints")) {
            text += fmt::format("/{}:{}", checkpoint.at("spp").get<std::uint32_t>(),
                                checkpoint.at("film_hash").get<std::string>());
        }
        // Cells without independent halves have no bias2 to share, so they have a key of their own.
        return text + (journal.cell(cell.name)->at("convergence").at("independent_samples") ? "" : "/dependent");
    }
    const std::string& owner(const Journal& journal, const Cell& cell, const Json& sample) const {
        return owners_.at(key(journal, cell, sample));
    }

    std::map<std::string, std::string> owners_;
};

OrderedJson studies_json(const Suite& suite) {
    OrderedJson studies = OrderedJson::array();
    for (const Study& study : suite.studies) {
        studies.push_back({{"name", study.name},
                           {"title", study.title},
                           {"figure", study.figure},
                           {"type", study.convergence ? "convergence" : "time"}});
        if (study.convergence && study.convergence->without_checkpoints) {
            studies.push_back({{"name", study.name + std::string(without_checkpoints_suffix)},
                               {"title", study.title + ", without checkpoints"},
                               {"figure", ""},
                               {"type", "time"}});
        }
    }
    return studies;
}

}  // namespace

// Marks low clocks and foreign load, judged over the whole run: a sample's clock against the highest that was seen, its
// foreign load against its own time.
void mark_low_clocks(OrderedJson& rows) {
    const auto clocks = [](const OrderedJson& row, double missing) {
        return std::pair(row.value("pt_clock_mhz_before", missing), row.value("pt_clock_mhz_after", missing));
    };
    double highest = 0;
    for (const OrderedJson& row : rows) {
        const auto [before, after] = clocks(row, 0.0);
        highest = std::max({highest, before, after});
    }
    for (OrderedJson& row : rows) {
        if (row.contains("pt_low_clock")) {
            const auto [before, after] = clocks(row, highest);
            row["pt_low_clock"] = std::min(before, after) < 0.9 * highest ? 1 : 0;
        }
    }
}

std::string rows_on_lines(const OrderedJson& value) {
    if (!value.is_structured() || value.empty()) {
        return value.dump();
    }
    std::string text;
    for (const auto& [key, member] : value.items()) {
        text += text.empty() ? "\n" : ",\n";
        text += value.is_array() ? member.dump() : OrderedJson(key).dump() + ": " + rows_on_lines(member);
    }
    return (value.is_array() ? "[" : "{") + text + (value.is_array() ? "\n]" : "\n}");
}

Disturbance disturbance_of(const Plan& plan, const Journal& journal) {
    OrderedJson rows = OrderedJson::array();
    for (const Cell& cell : plan.cells) {
        for (const Json& sample : journal.samples(cell.name)) {
            rows.push_back(sample_row(cell.name, 0, 1, 0, sample));
            rows.back()["pt_contended"] = is_disturbed(sample, cell.backend) ? 1 : 0;
        }
    }
    mark_low_clocks(rows);
    Disturbance found;
    for (const OrderedJson& row : rows) {
        const bool contended = row.at("pt_contended") == 1;  // so that the time may be wrong for it
        const bool low_clock = row.at("pt_low_clock") == 1;
        found.samples += 1;
        found.disturbed += contended || low_clock ? 1u : 0u;
        found.throttled += contended && is_throttled(row) ? 1u : 0u;
        found.contended += contended && !is_throttled(row) ? 1u : 0u;
        found.low_clock += low_clock ? 1u : 0u;
        found.clock_unknown += row.value("pt_clock_unknown", 0) == 1 ? 1u : 0u;
    }
    return found;
}

bool is_throttled(const Json& sample) { return sample.value("pt_throttled_periods", 0.0) > 0; }

bool is_disturbed(const Json& sample, Backend backend) {
    constexpr double most_host_share = 0.02;
    const double wall = sample.at("pt_wall_ms").get<double>();
    const bool was_late = 1 - sample.value("pt_device_ms", 0.0) / wall > most_host_share;
    // The device's time goes on while its host is late with the answer that it waits for.
    const bool was_waited_for = sample.value("pt_host_waits", 0.0) > 0;
    return is_contended(sample) && (backend != Backend::cuda || was_late || was_waited_for);
}

std::string in_words(const Disturbance& d) {
    std::string text = fmt::format("disturbed: {} of {}", d.disturbed, counted(d.samples, "sample"));
    if (d.disturbed > 0) {
        text += fmt::format(" (other processes {}, {}low clock {})", d.contended,
                            d.throttled > 0 ? fmt::format("CPU quota {}, ", d.throttled) : "", d.low_clock);
    }
    if (d.clock_unknown > 0) {
        text += fmt::format("; clock unknown in {}: cycles are not compared", d.clock_unknown);
    }
    return text;
}

namespace {

// Calls `read()`, which reads of a journal what only another program, or an editor, can have written otherwise; what it
// throws becomes an InputError that names the journal.
template <class Read>
auto guarded(const Journal& journal, const Read& read) {
    try {
        return read();
    } catch (const nlohmann::detail::exception& error) {
        throw InputError(journal.file(), "a cell or sample", error.what(),
                         "what ptbench wrote; remove the file to start over");
    }
}

void check_samples_have_cells(const Plan& plan, const Journal& journal) {
    for (const Cell& cell : plan.cells) {
        if (journal.cell(cell.name) == nullptr && !journal.samples(cell.name).empty()) {
            throw InputError(journal.file(), cell.name, "samples without the cell's own line",
                             "what ptbench wrote; remove the file to start over");
        }
    }
}

OrderedJson not_applicable_json(const NotApplicable& entry) {
    OrderedJson json{{"study", entry.study},
                     {"scene", entry.scene},
                     {"variant", shown_name(entry.variant, entry.backend)},
                     {"variant_id", variant_id(entry.variant, entry.backend)},
                     {"axes", axes_json(entry.variant)},
                     {"reason", entry.reason.text},
                     {"reason_code", entry.reason.code}};
    if (!entry.reason.axis.empty()) {
        json["reason_axis"] = entry.reason.axis;
    }
    return json;
}

std::string text_of_result(const Plan& plan, const Suite& suite, const Journal& journal, const RunFacts& facts) {
    check_samples_have_cells(plan, journal);
    const SharedErrors shared(plan, journal);
    OrderedJson rows = OrderedJson::array();
    OrderedJson cells = OrderedJson::array();
    for (std::size_t family = 0; family < plan.cells.size(); ++family) {
        const Cell& cell = plan.cells[family];
        cells.push_back(cell_json(cell, journal, facts.repetitions));
        const std::vector<Json>& samples = journal.samples(cell.name);
        if (cells.back().contains("convergence")) {
            cells.back()["convergence"]["shared_with"] = shared.shared_with(journal, cell);
        }
        for (std::size_t i = 0; i < samples.size(); ++i) {
            rows.push_back(sample_row(cell.name, family, facts.repetitions, i, samples[i]));
            if (cell.convergence) {
                shared.mark(journal, cell, samples[i], rows.back());
            }
        }
        if (!samples.empty()) {
            add_aggregate_rows(rows, cell.name, family, facts.repetitions, samples);
        }
        if (cells.back()["status"] == "failed") {
            rows.push_back(failed_row(cell.name, family, facts.repetitions, cells.back()["reason"]));
        }
    }
    mark_low_clocks(rows);
    OrderedJson run = facts.run;
    run["sessions"] = journal.sessions();
    OrderedJson not_applicable = OrderedJson::array();
    for (const NotApplicable& entry : plan.not_applicable) {
        not_applicable.push_back(not_applicable_json(entry));
    }
    OrderedJson baselines;
    for (const std::string_view axis : axis_names) {
        baselines[std::string(axis)] = Registry::instance().baseline(facts.backend)[axis];
    }
    const OrderedJson result{{"context", context(facts)},
                             {"benchmarks", rows},
                             {"ptbench",
                              {{"run", run},
                               {"studies", studies_json(suite)},
                               {"baselines", baselines},
                               {"cells", cells},
                               {"retakes", retakes_json(plan, journal, facts.most_retakes)},
                               {"not_applicable", not_applicable}}}};
    return rows_on_lines(result) + "\n";
}

}  // namespace

std::string result_json(const Plan& plan, const Suite& suite, const Journal& journal, const RunFacts& facts) {
    return guarded(journal, [&] { return text_of_result(plan, suite, journal, facts); });
}

void check_journal(const Plan& plan, const Suite& suite, const Journal& journal) {
    guarded(journal, [&] {
        // These facts are checked too, for the runner reads them besides what goes into the result.
        for (const Cell& cell : plan.cells) {
            const Json* facts = journal.cell(cell.name);
            if (facts != nullptr && facts->at("status").get<std::string>() == "ok" && cell.convergence) {
                (void)facts->at("convergence").at("expected_mse").get<double>();
            }
            for (const Json& sample : journal.samples(cell.name)) {
                (void)imprint_of_sample(sample);
                (void)sample.at("pt_rays_per_second").get<double>();
                (void)is_disturbed(sample, cell.backend);
                if (const std::string fault = fault_of_sample(sample); !fault.empty()) {
                    throw InputError(journal.file(), cell.name, "a sample with " + fault,
                                     "what a render can leave; remove the file to start over");
                }
            }
        }
        return text_of_result(plan, suite, journal, {});
    });
}

}  // namespace pt
