#include "harness/bench/retakes.h"

#include <algorithm>

#include <fmt/format.h>

#include "harness/counted.h"

namespace pt {

namespace {

std::size_t disturbed_in(const Cell& cell, const Journal& journal) {
    const std::vector<Sample>& samples = journal.samples(cell.name);
    return static_cast<std::size_t>(std::count_if(
        samples.begin(), samples.end(), [&](const Sample& sample) { return is_disturbed(sample, cell.backend); }));
}

}  // namespace

std::vector<std::size_t> to_retake(const Cell& cell, const Journal& journal, int most) {
    std::vector<std::size_t> indices;
    const std::vector<Sample>& samples = journal.samples(cell.name);
    const std::size_t given = journal.retaken(cell.name).size();
    for (std::size_t i = 0; i < samples.size() && given + indices.size() < static_cast<std::size_t>(most); ++i) {
        if (journal.is_ok(cell.name) && is_disturbed(samples[i], cell.backend)) {
            indices.push_back(i);
        }
    }
    return indices;
}

std::string retakes_in_words(const Plan& plan, const Journal& journal, int most) {
    std::size_t taken = 0, at_limit = 0, left = 0;
    for (const Cell& cell : plan.cells) {
        const std::size_t given = journal.retaken(cell.name).size();
        taken += given;
        if (!journal.is_ok(cell.name) || disturbed_in(cell, journal) == 0) {
            continue;
        }
        const bool is_at_limit = given >= static_cast<std::size_t>(most);
        at_limit += is_at_limit ? 1u : 0u;
        left += is_at_limit ? 0u : disturbed_in(cell, journal);
    }
    if (taken == 0 && at_limit == 0 && left == 0) {
        return "";
    }
    std::string text = fmt::format("retaken: {}, at most {} a cell", counted(taken, "disturbed sample"), most);
    if (at_limit != 0) {
        text += fmt::format("; {} came to that limit with disturbed samples left", counted(at_limit, "cell"));
    }
    if (left != 0) {
        text += fmt::format("; interrupted before {} could be", counted(left, "other"));
    }
    return text;
}

nlohmann::ordered_json retakes_json(const Plan& plan, const Journal& journal, int most) {
    nlohmann::ordered_json before = nlohmann::ordered_json::array();
    for (const Cell& cell : plan.cells) {
        const std::vector<Sample>& samples = journal.samples(cell.name);
        for (const Sample& sample : journal.retaken(cell.name)) {
            const auto in_its_place = std::find_if(samples.begin(), samples.end(),
                                                   [&](const Sample& other) { return other.seed == sample.seed; });
            before.push_back({{"cell", cell.name},
                              {"repetition_index", in_its_place - samples.begin()},
                              {"sample", nlohmann::ordered_json(sample)}});
        }
    }
    return {{"most_per_cell", most}, {"samples", before}};
}

}  // namespace pt
