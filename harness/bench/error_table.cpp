#include "harness/bench/error_table.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <tuple>

#include <fmt/format.h>

#include "harness/bench/convergence_study.h"
#include "harness/error/distributions.h"
#include "limits_of_judgement.h"  // generated from analysis/ptbench/io/limits.json
#include "variants/registry.h"
#include "variants/variant_name.h"

namespace pt {

namespace {

double mean_of(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

// Percentiles of a bootstrap over `count` seeds, moved outwards for few seeds (Hesterberg 2015). This corrects the
// underestimated spread of small samples and adds the tails of Student's t.
RatioInterval expanded_interval(std::vector<double> drawn, std::size_t count) {
    const double n = static_cast<double>(count);
    const double tail = normal_upper(std::sqrt(n / (n - 1)) * student_t_deviate(0.025, n - 1));
    std::sort(drawn.begin(), drawn.end());
    const double last = static_cast<double>(drawn.size() - 1);
    return {drawn[static_cast<std::size_t>(std::floor(tail * last))],
            drawn[static_cast<std::size_t>(std::ceil((1 - tail) * last))]};
}

// The product of mean error and median time, over the seeds that one resample of a bootstrap has drawn.
double work_of(const std::vector<double>& errors, const std::vector<double>& ms,
               const std::vector<std::uint32_t>& drawn) {
    double error = 0;
    std::vector<double> some_ms(drawn.size());
    for (std::size_t i = 0; i < drawn.size(); ++i) {
        error += errors[drawn[i]];
        some_ms[i] = ms[drawn[i]];
    }
    return error / static_cast<double>(drawn.size()) * median_of(std::move(some_ms));
}

std::optional<ErrorEfficiency> efficiency(const LastErrors& own, const LastErrors& base,
                                          std::vector<double> LastErrors::*errors) {
    const std::size_t count = (own.*errors).size();
    if (count != (base.*errors).size() || mean_of(own.*errors) <= 0 || mean_of(base.*errors) <= 0) {
        return std::nullopt;
    }
    const double samples = static_cast<double>(base.cell->spp) / own.cell->spp;
    std::vector<std::uint32_t> drawn(count);
    std::iota(drawn.begin(), drawn.end(), 0u);
    const auto ratio_of_drawn = [&] {
        return samples * work_of(base.*errors, base.ms_per_spp, drawn) / work_of(own.*errors, own.ms_per_spp, drawn);
    };
    ErrorEfficiency found{.value = ratio_of_drawn()};
    BootstrapRandom random;
    std::vector<double> ratios(limits::resamples);
    for (double& ratio : ratios) {
        for (std::uint32_t& seed : drawn) {
            seed = random.below(static_cast<std::uint32_t>(count));
        }
        ratio = ratio_of_drawn();
    }
    found.interval = expanded_interval(std::move(ratios), count);
    return found;
}

std::vector<std::string> settings_in_which_differ(const Cell& cell, const Cell& other) {
    std::vector<std::string> names;
    for (const std::string_view axis : axis_names) {
        if (cell.variant[axis] != other.variant[axis]) {
            names.emplace_back(axis);
        }
    }
    // Scenes whose names differ only in the reference scene's name in front ("box_fog", "hall_fog") count as equal.
    const auto scene_of = [](const Cell& c) {
        const std::string& name = c.scene->name;
        const std::string head = c.convergence->reference.scene->name + "_";
        return name.starts_with(head) ? "…_" + name.substr(head.size()) : name;
    };
    if (scene_of(cell) != scene_of(other)) {
        names.emplace_back("scene");
    }
    for (const auto& [name, value] : other.variant.tuning) {
        const auto own = cell.variant.tuning.find(name);
        if (own == cell.variant.tuning.end() || own->second != value) {
            names.push_back(name);
        }
    }
    return names;
}

const CheckpointFacts* errors_of_last(const Sample& sample, std::size_t checkpoints) {
    return sample.checkpoints && sample.checkpoints->size() == checkpoints ? &sample.checkpoints->back() : nullptr;
}

std::string image_name(const Cell& cell) {
    const ReferenceTask& reference = cell.convergence->reference;
    return fmt::format("{} {}x{}, depth {} on {}", reference.scene->name, cell.settings.width, cell.settings.height,
                       reference.depth, to_string(cell.backend));
}

}  // namespace

std::optional<ErrorEfficiency> LastErrors::efficiency_by_mse(const LastErrors& baseline) const {
    return efficiency(*this, baseline, &LastErrors::mse);
}

std::optional<ErrorEfficiency> LastErrors::efficiency_by_rel_mse(const LastErrors& baseline) const {
    return efficiency(*this, baseline, &LastErrors::rel_mse);
}

namespace {

// The errors of a cell at its last checkpoint; none if it failed, a sample has no errors, or there is only one seed.
std::optional<LastErrors> errors_of(const Cell& cell, const Journal& journal) {
    if (journal.has_failed(cell.name)) {
        return std::nullopt;
    }
    LastErrors found{.cell = &cell};
    for (const Sample& sample : journal.samples(cell.name)) {
        const CheckpointFacts* const last = errors_of_last(sample, cell.convergence->checkpoints.size());
        if (last == nullptr || !last->mse_dual || !last->rel_mse_dual) {
            return std::nullopt;
        }
        found.mse.push_back(*last->mse_dual);
        found.rel_mse.push_back(*last->rel_mse_dual);
    }
    if (found.mse.size() < 2) {
        return std::nullopt;
    }
    Times times = times_of(cell, journal);
    found.ms_per_spp = std::move(times.ms_per_spp);
    found.is_contended = times.is_contended;
    return found;
}

// The cell that makes the same render without checkpoints; null if there is none.
const Cell* companion_of(const Plan& plan, const Cell& cell) {
    const std::string name = cell.name.substr(0, cell.name.size() - checkpoints_suffix.size());
    const auto found =
        std::find_if(plan.cells.begin(), plan.cells.end(), [&](const Cell& c) { return c.name == name; });
    return found == plan.cells.end() ? nullptr : &*found;
}

}  // namespace

std::vector<LastErrors> last_errors(const Plan& plan, const Cells& cells, const Journal& journal) {
    std::vector<LastErrors> found;
    std::vector<Times> alone;
    for (const Cell* const cell : cells) {
        std::optional<LastErrors> errors = errors_of(*cell, journal);
        if (!errors) {
            continue;
        }
        const Cell* const companion = companion_of(plan, *cell);
        if (companion != nullptr && !journal.has_failed(companion->name) &&
            journal.samples(companion->name).size() == errors->mse.size()) {
            alone.push_back(times_of(*companion, journal));
        }
        found.push_back(std::move(*errors));
    }
    for (std::size_t i = 0; alone.size() == found.size() && i < found.size(); ++i) {
        found[i].ms_per_spp = std::move(alone[i].ms_per_spp);
        found[i].is_contended = alone[i].is_contended;
    }
    return found;
}

const LastErrors* baseline_of(const std::vector<LastErrors>& group, const Journal& journal) {
    const auto unlikeness = [&](const LastErrors& errors) {
        const Cell& cell = *errors.cell;
        const ConvergenceFacts& facts = journal.cell(cell.name)->convergence.value();
        const bool is_plain = facts.independent_samples && facts.biases.empty();
        const Variant usual = Registry::instance().baseline(cell.backend);
        int unusual = 0, unusual_estimators = 0;
        for (const Axis& axis : axis_table) {
            const bool differs = cell.variant[axis.key] != usual[axis.key];
            unusual += differs ? 1 : 0;
            unusual_estimators += differs && axis.decides_error ? 1 : 0;
        }
        std::size_t to_others = 0;
        for (const LastErrors& other : group) {
            to_others += settings_in_which_differ(cell, *other.cell).size();
        }
        return std::tuple(!is_plain, unusual_estimators, to_others, unusual, cell.variant.tuning.size());
    };
    const auto least = std::min_element(group.begin(), group.end(), [&](const LastErrors& a, const LastErrors& b) {
        return unlikeness(a) < unlikeness(b);
    });
    return least == group.end() ? nullptr : &*least;
}

std::vector<Cells> by_image(const Cells& cells) {
    std::map<std::string, std::size_t> places;
    std::vector<Cells> groups;
    for (const Cell* const cell : cells) {
        const auto [place, is_new] = places.try_emplace(image_name(*cell), groups.size());
        if (is_new) {
            groups.emplace_back();
        }
        groups[place->second].push_back(cell);
    }
    return groups;
}

namespace {

std::string efficiency_text(const std::optional<ErrorEfficiency>& efficiency) {
    if (!efficiency) {
        return "-";
    }
    const double value = efficiency->value;
    return fmt::format("{:.{}f} {}", value, value < 10 ? 3 : 2, interval_text(*efficiency->interval));
}

struct Line {
    std::string time = {}, mse = {}, rel_mse = {}, by_mse = {}, by_rel_mse = {}, note = {};

    std::string text(const std::string& variant) const {
        return fmt::format("{:>10}  {:>9}  {:>9}  {:<22}  {:<22}  {:<9}  {}\n", time, mse, rel_mse, by_mse, by_rel_mse,
                           note, variant);
    }
};

Line line_of(const LastErrors& errors, const LastErrors& baseline) {
    Line line{.time = fmt::format("{:.4g}", median_of(errors.ms_per_spp)),
              .mse = fmt::format("{:.3g}", mean_of(errors.mse)),
              .rel_mse = fmt::format("{:.3g}", mean_of(errors.rel_mse))};
    if (&errors == &baseline) {
        line.note = "baseline";
        return line;
    }
    line.by_mse = efficiency_text(errors.efficiency_by_mse(baseline));
    line.by_rel_mse = efficiency_text(errors.efficiency_by_rel_mse(baseline));
    line.note = errors.is_contended || baseline.is_contended ? "disturbed" : "";
    return line;
}

std::string lines_of(const Cells& group, const std::vector<LastErrors>& errors, const LastErrors* baseline,
                     const Journal& journal) {
    std::string text;
    for (const Cell* const cell : group) {
        const std::string name = shown_name(cell->variant, cell->backend);
        const auto own =
            std::find_if(errors.begin(), errors.end(), [&](const LastErrors& one) { return one.cell == cell; });
        if (own != errors.end()) {
            text += line_of(*own, *baseline).text(name);
        } else if (journal.has_failed(cell->name)) {
            text += Line{.note = "FAILED"}.text(name);
        }
    }
    return text;
}

std::string spps_of(const Cells& cells) {
    std::set<std::uint32_t> spps;
    for (const Cell* const cell : cells) {
        spps.insert(cell->spp);
    }
    return fmt::format("{}", fmt::join(spps, ", "));
}

}  // namespace

std::string error_table(const Plan& plan, const Cells& cells, const Journal& journal) {
    std::string text;
    for (const Cells& group : by_image(cells)) {
        const std::vector<LastErrors> errors = last_errors(plan, group, journal);
        const std::string lines = lines_of(group, errors, baseline_of(errors, journal), journal);
        if (lines.empty()) {
            continue;
        }
        text += fmt::format(
            "{}: errors at {} spp; efficiency: the baseline's error x time over the variant's, 95 % intervals\n",
            image_name(*group.front()), spps_of(group));
        text += Line{.time = "ms/spp",
                     .mse = "MSE",
                     .rel_mse = "relMSE",
                     .by_mse = "efficiency by MSE",
                     .by_rel_mse = "by relMSE"}
                    .text("variant") +
                lines;
    }
    return text;
}

}  // namespace pt
