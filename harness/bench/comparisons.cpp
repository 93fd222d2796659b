#include "harness/bench/comparisons.h"

#include <algorithm>
#include <map>

#include <fmt/format.h>

#include "harness/bench/error_table.h"

namespace pt {

Cells cells_of_study(const Plan& plan, const std::string& study) {
    Cells cells;
    for (const Cell& cell : plan.cells) {
        if (std::find(cell.studies.begin(), cell.studies.end(), study) != cell.studies.end()) {
            cells.push_back(&cell);
        }
    }
    return cells;
}

Times times_of(const Cell& cell, const Journal& journal) {
    return times_of(journal.samples(cell.name), cell.spp, cell.backend);
}

ComparisonFacts Comparison::facts() const {
    ComparisonFacts facts{.study = study, .cell = cell, .baseline = baseline, .reason_code = to_code(verdict.reason)};
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

Comparison compared(const Study& study, const ComparedCell& cell, const ComparedCells& cells,
                    const Question& question) {
    Comparison comparison{.study = study.name, .cell = cell.name};
    const ComparedCell* const baseline = baseline_of(cell, cells, question);
    if (baseline == nullptr) {
        comparison.verdict.reason = WordReason::no_baseline;
        return comparison;
    }
    comparison.baseline = baseline->name;
    if (!baseline->times) {
        comparison.verdict.reason = WordReason::baseline_not_measured;
        return comparison;
    }
    comparison.ratio = ratio_estimate(cell.times->ms_per_spp, baseline->times->ms_per_spp);
    comparison.verdict = verdict_of(*comparison.ratio, *cell.times, *baseline->times);
    return comparison;
}

}  // namespace

std::vector<Comparison> comparisons_of(const ComparedRun& run, const std::vector<Study>& studies) {
    std::vector<Comparison> comparisons;
    for (const Study& study : studies) {
        const ComparedCells cells = run.of_study(study.name);
        const std::optional<Question> question = question_of(study, cells, run.baselines);
        for (const ComparedCell* const cell : question ? cells : ComparedCells()) {
            if (cell->times && !is_baseline(*cell, *question)) {
                comparisons.push_back(compared(study, *cell, cells, *question));
            }
        }
    }
    return comparisons;
}

std::vector<Comparison> comparisons_of(const Plan& plan, const Suite& suite, const Journal& journal) {
    return comparisons_of(compared_run(plan, journal), suite.studies);
}

namespace {

std::string ratio_text(double ratio) { return fmt::format("{:.{}f}", ratio, ratio < 10 ? 3 : 2); }

struct Row {
    std::string time, ratio, interval, verdict;
};

class Table {
public:
    Table(const ComparedRun& run, const std::vector<Comparison>& comparisons) : run_(run), comparisons_(comparisons) {}

    void add_study(const Study& study, const std::string& title) {
        const ComparedCells cells = run_.of_study(study.name);
        const std::optional<Question> question = question_of(study, cells, run_.baselines);
        if (!title.empty()) {
            text_ += title + "\n";
        }
        std::string group;
        for (const ComparedCell* const cell : ordered(cells)) {
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
            text_ += line(*row, cell->variant);
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
    static std::string group_of(const ComparedCell& cell) {
        return fmt::format("{} {}x{}, depth {}, {} spp on {}", cell.scene, cell.width, cell.height, cell.depth,
                           cell.spp, to_string(cell.backend));
    }
    // Sorts a table's cells into groups of one scene and setting each, in the order of each group's first cell.
    static ComparedCells ordered(const ComparedCells& cells) {
        std::map<std::string, std::size_t> ranks;
        for (const ComparedCell* const cell : cells) {
            ranks.try_emplace(group_of(*cell), ranks.size());
        }
        ComparedCells sorted = cells;
        std::stable_sort(sorted.begin(), sorted.end(), [&](const ComparedCell* a, const ComparedCell* b) {
            return ranks[group_of(*a)] < ranks[group_of(*b)];
        });
        return sorted;
    }
    std::optional<Row> row_of(const Study& study, const ComparedCell& cell, const std::optional<Question>& question) {
        if (cell.has_failed) {
            return Row{"", "", "", "FAILED"};
        }
        if (!cell.times) {
            return std::nullopt;
        }
        Row row{fmt::format("{:.4g}", median_of(cell.times->ms_per_spp)), "", "", ""};
        if (question && is_baseline(cell, *question)) {
            row.verdict = "baseline";
        }
        const auto comparison = std::find_if(comparisons_.begin(), comparisons_.end(), [&](const Comparison& one) {
            return one.cell == cell.name && one.study == study.name;
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

    const ComparedRun& run_;
    const std::vector<Comparison>& comparisons_;
    std::string text_;
    std::map<std::string, int> reasons_;
};

}  // namespace

std::string verdict_table(const Plan& plan, const Suite& suite, const Journal& journal,
                          const std::vector<Comparison>& comparisons) {
    const ComparedRun run = compared_run(plan, journal);
    Table table(run, comparisons);
    for (const Study& study : suite.studies) {
        const Cells cells = cells_of_study(plan, study.name);
        const bool is_named = suite.studies.size() > 1 && !cells.empty();
        const std::string title = is_named ? fmt::format("{}: {}", study.name, study.title) : "";
        if (study.convergence) {
            table.add((is_named ? title + "\n" : "") + error_table(plan, cells, journal));
        } else {
            table.add_study(study, title);
        }
    }
    return table.text();
}

}  // namespace pt
