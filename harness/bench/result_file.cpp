#include "harness/bench/result_file.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

#include <fmt/format.h>

#include "harness/bench/convergence_study.h"
#include "harness/bench/retakes.h"
#include "harness/counted.h"
#include "harness/ranks/machine_context.h"
#include "harness/ranks/ranks.h"
#include "harness/scene/places.h"
#include "harness/variant_json.h"
#include "variants/variant_name.h"

namespace pt {

namespace {

using OrderedJson = nlohmann::ordered_json;

OrderedJson context(const RunFacts& facts) {
    BenchmarkContext benchmark = BenchmarkContext::now();
    benchmark.date = facts.date;
    CallContext call{.command_line = facts.command_line,
                     .suite = facts.suite,
                     .backend = std::string(to_string(facts.backend)),
                     .status = facts.completed ? "completed" : "interrupted"};
    if (ranks().count > 1) {
        call.rank_hosts = ranks().hosts;
    }
    OrderedJson json(benchmark);
    add_fields(json, machine_context(facts.backend));
    add_fields(json, call);
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

OrderedJson sample_row(const std::string& cell, std::size_t family, int repetitions, std::size_t index,
                       const Sample& sample) {
    OrderedJson row = row_head(cell, "", family, repetitions);
    row["repetition_index"] = index;
    row["threads"] = 1;
    row["iterations"] = 1;
    add_sample_to_row(row, sample);
    return row;
}

void add_aggregate_rows(OrderedJson& rows, const std::string& cell, std::size_t family, int repetitions,
                        const std::vector<Sample>& samples) {
    std::vector<double> wall, cpu;
    for (const Sample& sample : samples) {
        wall.push_back(sample.wall_ms);
        cpu.push_back(sample.cpu_ms);
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

// The values of all tunables of a cell, standard values included.
OrderedJson tunables_json(const Cell& cell) {
    OrderedJson json = OrderedJson::object();
    for (const Tunable& t : tunables_of(cell.variant, cell.backend)) {
        json[std::string(t.name)] = tunable(cell.variant, t.name, cell.backend);
    }
    return json;
}

// Adds the facts about a cell from the journal, with the status "interrupted" if the run ended too early for it.
void add_known(OrderedJson& json, const Cell& cell, const Journal& journal, int repetitions, std::string shared_with) {
    const CellFacts* known = journal.cell(cell.name);
    if (known == nullptr) {
        json["status"] = "interrupted";
        json["reason"] = "the run ended before this cell was reached";
        return;
    }
    CellFacts facts = *known;
    if (facts.convergence) {
        facts.convergence->shared_with = std::move(shared_with);
    }
    add_fields(json, facts);
    if (facts.status == CellStatus::ok && static_cast<int>(journal.samples(cell.name).size()) < repetitions) {
        json["status"] = "interrupted";
        json["reason"] = "the run ended before this cell had all its samples";
    }
}

OrderedJson cell_json(const Cell& cell, const Journal& journal, int repetitions, std::string shared_with) {
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
    add_known(json, cell, journal, repetitions, std::move(shared_with));
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

// Films with the same bits have the same errors; this map says which cell owns them. The owner is the first cell of the
// plan with these films at all checkpoints.
class SharedErrors {
public:
    SharedErrors(const Plan& plan, const Journal& journal) {
        for (const Cell& cell : plan.cells) {
            for (const Sample& sample : journal.samples(cell.name)) {
                if (cell.convergence) {
                    owners_.try_emplace(key(journal, cell, sample), cell.name);
                }
            }
        }
    }

    // Copies a sample and notes at its checkpoints (`shared`) whether another cell owns their films and errors.
    Sample marked(const Journal& journal, const Cell& cell, Sample sample) const {
        const bool shared = owner(journal, cell, sample) != cell.name;
        for (CheckpointFacts& checkpoint : sample.checkpoints.value()) {
            checkpoint.shared = shared;
        }
        return sample;
    }
    // The cell that owns the errors of all samples of `cell`; empty if that is `cell` itself, or if there are several.
    std::string shared_with(const Journal& journal, const Cell& cell) const {
        std::set<std::string> names;
        for (const Sample& sample : journal.samples(cell.name)) {
            names.insert(owner(journal, cell, sample));
        }
        return names.size() == 1 && *names.begin() != cell.name ? *names.begin() : "";
    }

private:
    static std::string key(const Journal& journal, const Cell& cell, const Sample& sample) {
        const ConvergenceFacts& facts = journal.cell(cell.name)->convergence.value();
        std::string text = facts.reference_hash();
        for (const CheckpointFacts& checkpoint : sample.checkpoints.value()) {
            text += fmt::format("/{}:{}", checkpoint.spp, checkpoint.film_hash);
        }
        // Cells without independent halves have no bias2, so they cannot share errors with cells that have it.
        return text + (facts.independent_samples ? "" : "/dependent");
    }
    const std::string& owner(const Journal& journal, const Cell& cell, const Sample& sample) const {
        return owners_.at(key(journal, cell, sample));
    }

    std::map<std::string, std::string> owners_;
};

OrderedJson studies_json(const Suite& suite) {
    OrderedJson studies = OrderedJson::array();
    for (const Study& study : suite.studies) {
        studies.push_back({{"name", study.name},
                           {"title", study.title},
                           {"compares", study.compares},
                           {"along", study.along},
                           {"type", study.convergence ? "convergence" : "time"}});
        if (study.convergence && study.convergence->without_checkpoints) {
            studies.push_back({{"name", study.name + std::string(without_checkpoints_suffix)},
                               {"title", study.title + ", without checkpoints"},
                               {"compares", ""},
                               {"along", ""},
                               {"type", "time"}});
        }
    }
    return studies;
}

}  // namespace

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
    std::vector<std::pair<const Sample*, Backend>> samples;
    for (const Cell& cell : plan.cells) {
        for (const Sample& sample : journal.samples(cell.name)) {
            samples.emplace_back(&sample, cell.backend);
        }
    }
    double highest = 0;
    for (const auto& [sample, backend] : samples) {
        highest = std::max(highest, highest_clock(*sample));
    }
    Disturbance found;
    for (const auto& [sample, backend] : samples) {
        const bool contended = is_disturbed(*sample, backend);  // whether other load or a quota falsified the time
        const bool low_clock = has_low_clock(*sample, highest);
        found.samples += 1;
        found.disturbed += contended || low_clock ? 1u : 0u;
        found.throttled += contended && is_throttled(*sample) ? 1u : 0u;
        found.contended += contended && !is_throttled(*sample) ? 1u : 0u;
        found.low_clock += low_clock ? 1u : 0u;
        found.clock_unknown += sample->clock_unknown == 1 ? 1u : 0u;
    }
    return found;
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

constexpr const char* what_ptbench_wrote = "what ptbench wrote; remove the file to start over";

// Throws InputError if the journal lacks facts or errors that a run needs to continue.
void check_cells_are_whole(const Plan& plan, const Journal& journal) {
    for (const Cell& cell : plan.cells) {
        const CellFacts* const facts = journal.cell(cell.name);
        const std::vector<Sample>& samples = journal.samples(cell.name);
        if (facts == nullptr && !samples.empty()) {
            throw InputError(journal.file(), cell.name, "samples without the cell's own line", what_ptbench_wrote);
        }
        const bool lacks_facts = facts != nullptr && cell.convergence && !facts->convergence &&
                                 (facts->status == CellStatus::ok || !samples.empty());
        const bool lacks_errors = cell.convergence && std::any_of(samples.begin(), samples.end(),
                                                                  [](const Sample& one) { return !one.checkpoints; });
        if (lacks_facts || lacks_errors) {
            throw InputError(journal.file(), cell.name, "a cell with checkpoints without its errors",
                             what_ptbench_wrote);
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

}  // namespace

std::string result_json(const Plan& plan, const Suite& suite, const Journal& journal, const RunFacts& facts) {
    check_cells_are_whole(plan, journal);
    const SharedErrors shared(plan, journal);
    OrderedJson rows = OrderedJson::array();
    OrderedJson cells = OrderedJson::array();
    for (std::size_t family = 0; family < plan.cells.size(); ++family) {
        const Cell& cell = plan.cells[family];
        const std::vector<Sample>& samples = journal.samples(cell.name);
        cells.push_back(cell_json(cell, journal, facts.repetitions,
                                  cell.convergence ? shared.shared_with(journal, cell) : std::string()));
        for (std::size_t i = 0; i < samples.size(); ++i) {
            rows.push_back(sample_row(cell.name, family, facts.repetitions, i,
                                      cell.convergence ? shared.marked(journal, cell, samples[i]) : samples[i]));
        }
        if (!samples.empty()) {
            add_aggregate_rows(rows, cell.name, family, facts.repetitions, samples);
        }
        if (journal.has_failed(cell.name)) {
            rows.push_back(failed_row(cell.name, family, facts.repetitions, journal.cell(cell.name)->reason));
        }
    }
    mark_low_clocks(rows);
    RunRecord run = facts.run;
    run.sessions = journal.sessions();
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
                              {{"run", OrderedJson(run)},
                               {"studies", studies_json(suite)},
                               {"baselines", baselines},
                               {"cells", cells},
                               {"comparisons", OrderedJson(facts.comparisons)},
                               {"retakes", retakes_json(plan, journal, facts.most_retakes)},
                               {"not_applicable", not_applicable}}}};
    return rows_on_lines(result) + "\n";
}

void check_journal(const Plan& plan, const Journal& journal) {
    check_cells_are_whole(plan, journal);
    for (const Cell& cell : plan.cells) {
        for (const Sample& sample : journal.samples(cell.name)) {
            if (const std::string fault = fault_of_sample(sample); !fault.empty()) {
                throw InputError(journal.file(), cell.name, "a sample with " + fault,
                                 "what a render can leave; remove the file to start over");
            }
        }
    }
}

}  // namespace pt
