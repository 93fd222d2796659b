#include "harness/bench/compared_run.h"

#include <algorithm>
#include <sstream>
#include <tuple>

#include "limits_of_judgement.h"  // generated from analysis/ptbench/io/limits.json
#include "variants/registry.h"
#include "variants/variant_name.h"

namespace pt {

namespace {

using OrderedJson = nlohmann::ordered_json;

bool is_axis(const std::string& name) {
    return std::find(std::begin(axis_names), std::end(axis_names), name) != std::end(axis_names);
}

using Choices = std::map<std::string, std::string>;

// A cell's choice on an axis; empty if the cell's result file is of an older program that did not have the axis.
std::string choice_on(const std::string& axis, const Choices& choices) {
    const auto choice = choices.find(axis);
    return choice == choices.end() ? "" : choice->second;
}

std::string first_varying_axis(const ComparedCells& cells) {
    for (const std::string_view name : axis_names) {
        const std::string axis(name);
        const auto differs = [&](const ComparedCell* cell) {
            return choice_on(axis, cell->axes) != choice_on(axis, cells.front()->axes);
        };
        if (std::any_of(cells.begin(), cells.end(), differs)) {
            return axis;
        }
    }
    return "";
}

std::optional<Question> question_of_tunable(const std::string& name, const ComparedCells& cells) {
    ComparedCells having;
    std::copy_if(cells.begin(), cells.end(), std::back_inserter(having),
                 [&](const ComparedCell* cell) { return cell->tunables.contains(name); });
    if (having.empty()) {
        return std::nullopt;
    }
    const auto standard = std::find_if(having.begin(), having.end(),
                                       [&](const ComparedCell* cell) { return !cell->tuned.contains(name); });
    const ComparedCell& first = standard == having.end() ? *having.front() : **standard;
    return Question{name, std::to_string(first.tunables.at(name)), true};
}

// The cell's choice on the compared axis, or its value of the compared tunable; empty if it has no such tunable.
std::string value_of(const ComparedCell& cell, const Question& question) {
    if (!question.is_tunable) {
        return choice_on(question.axis, cell.axes);
    }
    const auto value = cell.tunables.find(question.axis);
    return value == cell.tunables.end() ? "" : std::to_string(value->second);
}

// Whether an axis can be ignored when cells are matched: the sort key says nothing about a variant that does not sort.
bool says_nothing(std::string_view axis, const Question& question) {
    return axis == axes::sort_key && question.axis == axes::sorting && question.baseline == "none";
}

bool is_same_setting(const ComparedCell& cell, const ComparedCell& other, const Question& question) {
    const auto of = [](const ComparedCell& c) { return std::tie(c.scene, c.backend, c.depth, c.width, c.height); };
    return of(cell) == of(other) && std::all_of(cell.axes.begin(), cell.axes.end(), [&](const auto& choice) {
               return choice.first == question.axis || says_nothing(choice.first, question) ||
                      choice.second == choice_on(choice.first, other.axes);
           });
}

// How the tuning of two cells differs, in tunables that both have and that the study does not compare.
struct TuningDifference {
    bool is_comparable = true;  // whether the differing tunables are at their standards in both cells
    int differences = 0;
    int others_alone = 0;  // number of tuned values of the second cell whose tunables the first cell lacks
};

TuningDifference compare_tuning(const ComparedCell& cell, const ComparedCell& other, const Question& question) {
    TuningDifference found;
    for (const auto& [name, value] : cell.tunables) {
        const auto there = other.tunables.find(name);
        if (there == other.tunables.end() || name == question.axis || there->second == value) {
            continue;
        }
        found.differences += 1;
        found.is_comparable = found.is_comparable && !cell.tuned.contains(name) && !other.tuned.contains(name);
    }
    for (const std::string& name : other.tuned) {
        found.others_alone += cell.tunables.contains(name) ? 0 : 1;
    }
    return found;
}

Choices choices_of(const Variant& variant) {
    Choices choices;
    for (const std::string_view axis : axis_names) {
        choices[std::string(axis)] = variant[axis];
    }
    return choices;
}

ComparedCell compared_cell(const Cell& cell) {
    ComparedCell compared{.name = cell.name,
                          .studies = cell.studies,
                          .scene = cell.scene->name,
                          .backend = cell.backend,
                          .variant = shown_name(cell.variant, cell.backend),
                          .axes = choices_of(cell.variant),
                          .tunables = {},
                          .tuned = {},
                          .width = cell.settings.width,
                          .height = cell.settings.height,
                          .depth = cell.settings.depth,
                          .spp = cell.spp};
    for (const Tunable& t : tunables_of(cell.variant, cell.backend)) {
        compared.tunables[std::string(t.name)] = tunable(cell.variant, t.name, cell.backend);
    }
    for (const auto& [name, value] : cell.variant.tuning) {
        compared.tuned.insert(name);
    }
    return compared;
}

// Finds the tunables in a variant's shown name, which lists only those that are not at their standards.
std::set<std::string> tuned_in(const std::string& shown, const std::map<std::string, std::uint32_t>& tunables) {
    std::set<std::string> tuned;
    std::istringstream words(shown);
    for (std::string word; words >> word;) {
        if (const std::string name = word.substr(0, word.find('=')); tunables.contains(name)) {
            tuned.insert(name);
        }
    }
    return tuned;
}

ComparedCell compared_cell(const OrderedJson& cell) {
    ComparedCell compared{.name = cell.at("cell"),
                          .studies = cell.at("studies"),
                          .scene = cell.at("scene"),
                          .backend = cell.at("backend") == to_string(Backend::cuda) ? Backend::cuda : Backend::cpu,
                          .variant = cell.at("variant"),
                          .axes = cell.at("axes"),
                          .tunables = cell.at("tunables"),
                          .tuned = {},
                          .width = cell.at("resolution").at(0),
                          .height = cell.at("resolution").at(1),
                          .depth = cell.at("depth"),
                          .spp = cell.at("spp"),
                          .has_failed = cell.at("status") == "failed"};
    compared.tuned = tuned_in(compared.variant, compared.tunables);
    return compared;
}

void add_times(ComparedCell& cell, const std::vector<Sample>& samples) {
    if (!cell.has_failed && !samples.empty()) {
        cell.times = times_of(samples, cell.spp, cell.backend);
    }
}

}  // namespace

ComparedCells ComparedRun::of_study(const std::string& study) const {
    ComparedCells found;
    for (const ComparedCell& cell : cells) {
        if (std::find(cell.studies.begin(), cell.studies.end(), study) != cell.studies.end()) {
            found.push_back(&cell);
        }
    }
    return found;
}

ComparedRun compared_run(const Plan& plan) {
    ComparedRun run;
    for (const Cell& cell : plan.cells) {
        run.cells.push_back(compared_cell(cell));
    }
    if (!plan.cells.empty()) {
        run.baselines = choices_of(Registry::instance().baseline(plan.cells.front().backend));
    }
    return run;
}

ComparedRun compared_run(const Plan& plan, const Journal& journal) {
    ComparedRun run = compared_run(plan);
    for (ComparedCell& cell : run.cells) {
        cell.has_failed = journal.has_failed(cell.name);
        add_times(cell, journal.samples(cell.name));
    }
    return run;
}

ComparedRun compared_run(const OrderedJson& rows, const OrderedJson& cells, const OrderedJson& baselines) {
    std::map<std::size_t, std::vector<Sample>> samples;  // samples by number of their cell (a row's family_index)
    for (const OrderedJson& row : rows) {
        if (is_row_of_sample(row)) {
            samples[row.at("family_index").get<std::size_t>()].push_back(sample_of_row(row));
        }
    }
    ComparedRun run{.cells = {}, .baselines = baselines};
    for (const OrderedJson& cell : cells) {
        const std::vector<Sample>& own = samples[run.cells.size()];
        run.cells.push_back(compared_cell(cell));
        add_times(run.cells.back(), own);
    }
    return run;
}

std::optional<Question> question_of(const Study& study, const ComparedCells& cells,
                                    const std::map<std::string, std::string>& baselines) {
    if (cells.empty() || study.convergence) {
        return std::nullopt;
    }
    const bool is_open = study.compares.empty() && !study.along.empty();
    const std::string axis = is_open ? first_varying_axis(cells) : study.compares;
    if (!is_axis(axis)) {
        return question_of_tunable(axis, cells);
    }
    const std::string usual = choice_on(axis, baselines);
    const bool was_run = std::any_of(cells.begin(), cells.end(),
                                     [&](const ComparedCell* cell) { return choice_on(axis, cell->axes) == usual; });
    return Question{axis, was_run ? usual : choice_on(axis, cells.front()->axes)};
}

Suite with_questions(Suite suite, const Plan& plan) {
    const ComparedRun run = compared_run(plan);
    for (Study& study : suite.studies) {
        const std::optional<Question> question = question_of(study, run.of_study(study.name), run.baselines);
        if (study.compares.empty() && question) {
            study.compares = question->axis;
        }
    }
    return suite;
}

const ComparedCell* baseline_of(const ComparedCell& cell, const ComparedCells& cells, const Question& question) {
    const ComparedCell* best = nullptr;
    std::tuple<int, int, bool, int> least;
    const std::string key(axes::sort_key);
    for (const ComparedCell* const other : cells) {
        if (!is_baseline(*other, question) || !is_same_setting(cell, *other, question)) {
            continue;
        }
        const TuningDifference tuning = compare_tuning(cell, *other, question);
        if (!tuning.is_comparable) {
            continue;
        }
        const int keys = says_nothing(key, question) && choice_on(key, cell.axes) != choice_on(key, other->axes);
        const std::tuple unlikeness{keys, tuning.differences, other->spp != cell.spp, tuning.others_alone};
        if (best == nullptr || unlikeness < least) {
            best = other;
            least = unlikeness;
        }
    }
    return best;
}

bool is_baseline(const ComparedCell& cell, const Question& question) {
    return value_of(cell, question) == question.baseline;
}

Times times_of(const std::vector<Sample>& samples, std::uint32_t spp, Backend backend) {
    Times times;
    std::size_t disturbed = 0;
    bool has_clock = true;
    for (const Sample& sample : samples) {
        times.ms_per_spp.push_back(sample.wall_ms / spp);
        const std::optional<double> clock = clock_of(sample);
        has_clock = has_clock && clock;
        times.cycles.push_back(times.ms_per_spp.back() * clock.value_or(0) / 1e3);
        const bool is_one = is_disturbed(sample, backend);
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

}  // namespace pt
