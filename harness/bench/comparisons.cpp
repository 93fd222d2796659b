#include "harness/bench/comparisons.h"

#include <algorithm>
#include <map>
#include <tuple>

#include <fmt/format.h>

#include "harness/bench/convergence_study.h"
#include "harness/bench/error_table.h"
#include "limits_of_judgement.h"  // generated from analysis/ptbench/io/limits.json
#include "variants/registry.h"
#include "variants/variant_name.h"

namespace pt {

namespace {

using Tunables = std::map<std::string, std::uint32_t>;

bool is_axis(const std::string& name) {
    return std::find(std::begin(axis_names), std::end(axis_names), name) != std::end(axis_names);
}

std::string first_varying_axis(const Cells& cells) {
    for (const std::string_view axis : axis_names) {
        const auto differs = [&](const Cell* cell) { return cell->variant[axis] != cells.front()->variant[axis]; };
        if (std::any_of(cells.begin(), cells.end(), differs)) {
            return std::string(axis);
        }
    }
    return "";
}

// All tunables of a cell with their values, standard ones included.
Tunables tunables_of(const Cell& cell) {
    Tunables values;
    for (const Tunable& t : pt::tunables_of(cell.variant, cell.backend)) {
        values[std::string(t.name)] = tunable(cell.variant, t.name, cell.backend);
    }
    return values;
}

bool is_tuned(const Cell& cell, const std::string& name) { return cell.variant.tuning.contains(name); }

std::optional<Question> question_of_tunable(const std::string& name, const Cells& cells) {
    Cells having;
    std::copy_if(cells.begin(), cells.end(), std::back_inserter(having),
                 [&](const Cell* cell) { return tunables_of(*cell).contains(name); });
    if (having.empty()) {
        return std::nullopt;
    }
    const auto standard =
        std::find_if(having.begin(), having.end(), [&](const Cell* cell) { return !is_tuned(*cell, name); });
    const Cell& first = standard == having.end() ? *having.front() : **standard;
    return Question{name, std::to_string(tunables_of(first).at(name)), true};
}

// The cell's choice on the question's axis, or its value of the question's tunable; empty: it has no such tunable.
std::string value_of(const Cell& cell, const Question& question) {
    if (!question.is_tunable) {
        return cell.variant[question.axis];
    }
    const Tunables values = tunables_of(cell);
    const auto value = values.find(question.axis);
    return value == values.end() ? "" : std::to_string(value->second);
}

// A sort key says how a sort works: against a variant without a sort it may be any.
bool says_nothing(std::string_view axis, const Question& question) {
    return axis == axes::sort_key && question.axis == axes::sorting && question.baseline == "none";
}

bool is_same_setting(const Cell& cell, const Cell& other, const Question& question) {
    const auto of = [](const Cell& c) {
        return std::tuple(c.scene->name, c.backend, c.settings.depth, c.settings.width, c.settings.height);
    };
    return of(cell) == of(other) && std::all_of(axis_names.begin(), axis_names.end(), [&](std::string_view axis) {
               return axis == question.axis || says_nothing(axis, question) ||
                      cell.variant[axis] == other.variant[axis];
           });
}

// How two cells are tuned differently, in tunables that both have and that the question is not about.
struct TuningDifference {
    bool is_comparable = true;  // values are equal, or both cells are at their choices' standards
    int differences = 0;
    int others_alone = 0;  // values of the other's that are not standard and that this cell does not have
};

TuningDifference compare_tuning(const Cell& cell, const Cell& other, const Question& question) {
    const Tunables ours = tunables_of(cell), theirs = tunables_of(other);
    TuningDifference found;
    for (const auto& [name, value] : ours) {
        const auto there = theirs.find(name);
        if (there == theirs.end() || name == question.axis || there->second == value) {
            continue;
        }
        found.differences += 1;
        found.is_comparable = found.is_comparable && !is_tuned(cell, name) && !is_tuned(other, name);
    }
    for (const auto& [name, value] : other.variant.tuning) {
        found.others_alone += ours.contains(name) ? 0 : 1;
    }
    return found;
}

}  // namespace

Cells cells_of_study(const Plan& plan, const std::string& study) {
    Cells cells;
    for (const Cell& cell : plan.cells) {
        if (std::find(cell.studies.begin(), cell.studies.end(), study) != cell.studies.end()) {
            cells.push_back(&cell);
        }
    }
    return cells;
}

std::optional<Question> question_of(const Study& study, const Cells& cells) {
    if (cells.empty() || study.convergence) {
        return std::nullopt;
    }
    const bool is_open = study.compares.empty() && !study.along.empty();
    const std::string axis = is_open ? first_varying_axis(cells) : study.compares;
    if (!is_axis(axis)) {
        return question_of_tunable(axis, cells);
    }
    const std::string usual = Registry::instance().baseline(cells.front()->backend)[axis];
    const bool was_run =
        std::any_of(cells.begin(), cells.end(), [&](const Cell* cell) { return cell->variant[axis] == usual; });
    return Question{axis, was_run ? usual : cells.front()->variant[axis]};
}

const Cell* baseline_of(const Cell& cell, const Cells& cells, const Question& question) {
    const Cell* best = nullptr;
    std::tuple<int, int, bool, int> least;
    for (const Cell* const other : cells) {
        const TuningDifference tuning = compare_tuning(cell, *other, question);
        if (!is_baseline(*other, question) || !is_same_setting(cell, *other, question) || !tuning.is_comparable) {
            continue;
        }
        const int keys =
            says_nothing(axes::sort_key, question) && cell.variant[axes::sort_key] != other->variant[axes::sort_key];
        const std::tuple unlikeness{keys, tuning.differences, other->spp != cell.spp, tuning.others_alone};
        if (best == nullptr || unlikeness < least) {
            best = other;
            least = unlikeness;
        }
    }
    return best;
}

bool is_baseline(const Cell& cell, const Question& question) { return value_of(cell, question) == question.baseline; }

Times times_of(const Cell& cell, const Journal& journal) {
    Times times;
    const std::vector<Sample>& samples = journal.samples(cell.name);
    std::size_t disturbed = 0;
    bool has_clock = true;
    for (const Sample& sample : samples) {
        times.ms_per_spp.push_back(sample.wall_ms / cell.spp);
        const std::optional<double> clock = clock_of(sample);
        has_clock = has_clock && clock;
        times.cycles.push_back(times.ms_per_spp.back() * clock.value_or(0) / 1e3);
        const bool is_one = is_disturbed(sample, cell.backend);
        disturbed += is_one ? 1u : 0u;
        times.is_throttled = times.is_throttled || (is_one && is_throttled(sample));
    }
    if (!has_clock) {
        times.cycles.clear();
    }
    times.is_contended =
        static_cast<double>(disturbed) > limits::most_disturbed_share * static_cast<double>(samples.size());
    return times;
}

ComparisonFacts Comparison::facts() const {
    ComparisonFacts facts{.study = study, .cell = cell->name, .reason_code = to_code(verdict.reason)};
    if (baseline != nullptr) {
        facts.baseline = baseline->name;
    }
    if (ratio) {
        facts.ratio = ratio->value;
        facts.word = to_text(verdict.word);
        facts.in_time = to_text(verdict.in_time);
        if (ratio->interval) {
            facts.interval = {ratio->interval->low, ratio->interval->high};
        }
        if (verdict.in_cycles) {
            facts.in_cycles = to_text(*verdict.in_cycles);
        }
    }
    return facts;
}

namespace {

// A cell that failed does not count as measured: nobody knows what its samples timed.
bool is_measured(const Cell& cell, const Journal& journal) {
    return !journal.has_failed(cell.name) && !journal.samples(cell.name).empty();
}

Comparison compared(const Study& study, const Cell& cell, const Cells& cells, const Question& question,
                    const Journal& journal) {
    Comparison comparison{.study = study.name, .cell = &cell, .baseline = baseline_of(cell, cells, question)};
    if (comparison.baseline == nullptr) {
        comparison.verdict.reason = WordReason::no_baseline;
    } else if (!is_measured(*comparison.baseline, journal)) {
        comparison.verdict.reason = WordReason::baseline_not_measured;
    } else {
        const Times times = times_of(cell, journal), others = times_of(*comparison.baseline, journal);
        comparison.ratio = ratio_estimate(times.ms_per_spp, others.ms_per_spp);
        comparison.verdict = verdict_of(*comparison.ratio, times, others);
    }
    return comparison;
}

}  // namespace

std::vector<Comparison> comparisons_of(const Plan& plan, const Suite& suite, const Journal& journal) {
    std::vector<Comparison> comparisons;
    for (const Study& study : suite.studies) {
        const Cells cells = cells_of_study(plan, study.name);
        const std::optional<Question> question = question_of(study, cells);
        for (const Cell* const cell : question ? cells : Cells()) {
            if (is_measured(*cell, journal) && !is_baseline(*cell, *question)) {
                comparisons.push_back(compared(study, *cell, cells, *question, journal));
            }
        }
    }
    return comparisons;
}

namespace {

std::string ratio_text(double ratio) { return fmt::format("{:.{}f}", ratio, ratio < 10 ? 3 : 2); }

struct Row {
    std::string time, ratio, interval, verdict;
};

class Table {
public:
    Table(const Journal& journal, const std::vector<Comparison>& comparisons)
        : journal_(journal), comparisons_(comparisons) {}

    void add_study(const Study& study, const std::string& title, const Cells& cells) {
        const std::optional<Question> question = question_of(study, cells);
        if (!title.empty()) {
            text_ += title + "\n";
        }
        std::string group;
        for (const Cell* const cell : ordered(cells)) {
            const std::optional<Row> row = row_of(study, *cell, question);
            if (!row) {
                continue;
            }
            if (group != group_of(*cell)) {
                group = group_of(*cell);
                text_ += group +
                         (question ? fmt::format(": ratio to {}={}, all else equal", question->axis, question->baseline)
                                   : "") +
                         "\n" + line({"ms/spp", "ratio", "95 % interval", "verdict"}, "variant");
            }
            text_ += line(*row, shown_name(cell->variant, cell->backend));
        }
    }

    void add(const std::string& text) { text_ += text; }

    std::string text() const {
        std::string text = text_;
        for (const auto& [reason, count] : reasons_) {
            text += fmt::format("UNSURE ({}): {}\n", count, reason);
        }
        return text;
    }

private:
    static std::string line(const Row& row, const std::string& name) {
        return fmt::format("{:>10}  {:>6}  {:<16}  {:<8}  {}\n", row.time, row.ratio, row.interval, row.verdict, name);
    }
    static std::string group_of(const Cell& cell) {
        return fmt::format("{} {}x{}, depth {}, {} spp on {}", cell.scene->name, cell.settings.width,
                           cell.settings.height, cell.settings.depth, cell.spp, to_string(cell.backend));
    }
    // The cells with those of a group side by side, and groups in the order of their first cells.
    static Cells ordered(const Cells& cells) {
        std::map<std::string, std::size_t> ranks;
        for (const Cell* const cell : cells) {
            ranks.try_emplace(group_of(*cell), ranks.size());
        }
        Cells sorted = cells;
        std::stable_sort(sorted.begin(), sorted.end(),
                         [&](const Cell* a, const Cell* b) { return ranks[group_of(*a)] < ranks[group_of(*b)]; });
        return sorted;
    }
    std::optional<Row> row_of(const Study& study, const Cell& cell, const std::optional<Question>& question) {
        if (journal_.has_failed(cell.name)) {
            return Row{"", "", "", "FAILED"};
        }
        if (!is_measured(cell, journal_)) {
            return std::nullopt;
        }
        const Times times = times_of(cell, journal_);
        Row row{fmt::format("{:.4g}", median_of(times.ms_per_spp)), "", "", ""};
        if (question && is_baseline(cell, *question)) {
            row.verdict = "baseline";
        }
        const auto comparison = std::find_if(comparisons_.begin(), comparisons_.end(), [&](const Comparison& one) {
            return one.cell == &cell && one.study == study.name;
        });
        if (comparison != comparisons_.end() && comparison->ratio) {
            add_verdict(row, *comparison->ratio, comparison->verdict);
        }
        return row;
    }

    void add_verdict(Row& row, const RatioEstimate& ratio, const TimeVerdict& verdict) {
        row.ratio = ratio_text(ratio.value);
        row.interval = ratio.interval ? interval_text(*ratio.interval) : "";
        row.verdict = to_text(verdict.word);
        if (verdict.word == Word::unsure) {
            reasons_[in_words(verdict, ratio.samples)] += 1;
        }
    }

    const Journal& journal_;
    const std::vector<Comparison>& comparisons_;
    std::string text_;
    std::map<std::string, int> reasons_;
};

}  // namespace

std::string verdict_table(const Plan& plan, const Suite& suite, const Journal& journal,
                          const std::vector<Comparison>& comparisons) {
    Table table(journal, comparisons);
    for (const Study& study : suite.studies) {
        const Cells cells = cells_of_study(plan, study.name);
        const bool is_named = suite.studies.size() > 1 && !cells.empty();
        const std::string title = is_named ? fmt::format("{}: {}", study.name, study.title) : "";
        if (study.convergence) {
            table.add((is_named ? title + "\n" : "") + error_table(plan, cells, journal));
        } else {
            table.add_study(study, title, cells);
        }
    }
    return table.text();
}

}  // namespace pt
