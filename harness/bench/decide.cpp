#include "harness/bench/decide.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "harness/bench/compared_run.h"
#include "harness/counted.h"
#include "limits_of_judgement.h"  // generated from analysis/ptbench/io/limits.json

namespace pt {

namespace {

// Half width to which a confidence interval shall shrink, below that of the range of ratios with the verdict SAME, so
// that an interval that is not centred on 1 fits into that range.
constexpr double wanted_half_width = 0.8 * limits::least_difference;

bool is_good(const ComparedCell& cell, const Journal& journal) {
    return journal.is_ok(cell.name) && cell.times.has_value();
}

// The number of samples per cell that would narrow the confidence interval of a ratio of times to wanted_half_width; 0
// if the ratio has a verdict already, or if something else than the interval's width keeps the verdict open.
std::size_t samples_for(const Times& times, const Times& baseline) {
    const RatioEstimate ratio = ratio_estimate(times.ms_per_spp, baseline.ms_per_spp);
    if (times.is_contended || baseline.is_contended || ratio.samples < limits::fewest_samples || !ratio.interval ||
        word_of(*ratio.interval) != Word::unsure) {
        return 0;
    }
    const double half_width = (ratio.interval->high - ratio.interval->low) / 2;
    const double times_as_many = std::pow(half_width / wanted_half_width, 2);
    return static_cast<std::size_t>(std::ceil(static_cast<double>(ratio.samples) * std::min(times_as_many, 1e6)));
}

double seconds_of_a_sample(const Cell& cell, const Journal& journal) {
    std::vector<double> ms;
    for (const Sample& sample : journal.samples(cell.name)) {
        ms.push_back(sample.end_to_end_ms.value_or(sample.wall_ms));
    }
    return 1e-3 * median_of(ms);
}

using Wanted = std::map<std::string, std::size_t>;  // number of samples to reach, by cell name

void add_open_verdicts(Wanted& wanted, const Study& study, const ComparedRun& run, const Journal& journal) {
    const ComparedCells cells = run.of_study(study.name);
    const std::optional<Question> question = question_of(study, cells, run.baselines);
    for (const ComparedCell* const cell : question ? cells : ComparedCells()) {
        const ComparedCell* const baseline =
            is_baseline(*cell, *question) ? nullptr : baseline_of(*cell, cells, *question);
        if (baseline == nullptr || !is_good(*cell, journal) || !is_good(*baseline, journal)) {
            continue;
        }
        const std::size_t samples = samples_for(*cell->times, *baseline->times);
        for (const ComparedCell* const side : {cell, baseline}) {
            wanted[side->name] = std::max(wanted[side->name], samples);
        }
    }
}

}  // namespace

std::vector<WantedSamples> samples_to_decide(const Plan& plan, const Suite& suite, const Journal& journal,
                                             std::size_t most, double seconds) {
    const ComparedRun run = compared_run(plan, journal);
    Wanted wanted;
    for (const Study& study : suite.studies) {
        add_open_verdicts(wanted, study, run, journal);
    }
    std::vector<WantedSamples> found;
    double all_seconds = 0;
    for (const Cell& cell : plan.cells) {
        const std::size_t there = journal.samples(cell.name).size(), samples = std::min(wanted[cell.name], most);
        if (samples > there) {
            found.push_back({&cell, samples});
            all_seconds += static_cast<double>(samples - there) * seconds_of_a_sample(cell, journal);
        }
    }
    const double share = all_seconds > seconds ? seconds / all_seconds : 1;
    for (WantedSamples& one : found) {
        const std::size_t there = journal.samples(one.cell->name).size();
        one.samples = there + static_cast<std::size_t>(share * static_cast<double>(one.samples - there));
    }
    std::erase_if(found,
                  [&](const WantedSamples& one) { return one.samples <= journal.samples(one.cell->name).size(); });
    return found;
}

std::string decided_in_words(const Plan& plan, const Journal& journal, int repetitions) {
    std::vector<std::size_t> counts;
    for (const Cell& cell : plan.cells) {
        const std::size_t there = journal.samples(cell.name).size();
        if (there > static_cast<std::size_t>(repetitions)) {
            counts.push_back(there);
        }
    }
    if (counts.empty()) {
        return "";
    }
    const auto [fewest, most] = std::minmax_element(counts.begin(), counts.end());
    return fmt::format("more samples: {} {} {} to {}, for verdicts that were open by the width of their interval",
                       counted(counts.size(), "cell"), counts.size() == 1 ? "has" : "have", *fewest, *most);
}

}  // namespace pt
