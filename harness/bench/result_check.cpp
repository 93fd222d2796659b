#include "harness/bench/result_check.h"

#include <map>
#include <set>
#include <vector>

#include <fmt/format.h>

#include "harness/bench/facts/sample.h"

namespace pt {

namespace {

using OrderedJson = nlohmann::ordered_json;

class ResultChecker {
public:
    ResultChecker(const std::string& file, const OrderedJson& result)
        : file_(file), result_(result), cells_(result.at("ptbench").at("cells")), indices_(cells_.size()) {}

    void check() {
        for (const OrderedJson& row : result_.at("benchmarks")) {
            if (row.at("run_type") == "iteration" && !row.contains("error_occurred")) {
                check_row(row, row.at("family_index").get<std::size_t>());
            }
        }
        if (result_.at("ptbench").contains("retakes")) {
            for (const OrderedJson& retake : result_.at("ptbench").at("retakes").at("samples")) {
                check_retaken(retake);
            }
        }
        const OrderedJson& run = result_.at("ptbench").at("run");
        const std::size_t repetitions = run.at("repetitions"), most = run.value("most_repetitions", repetitions);
        for (std::size_t cell = 0; cell < cells_.size(); ++cell) {
            const std::set<std::size_t>& taken = indices_[cell];
            if (cells_.at(cell).at("status") == "ok" &&
                (taken.size() < repetitions || taken.size() > most || *taken.rbegin() + 1 != taken.size())) {
                fail(cell, fmt::format("{} samples", taken.size()),
                     most == repetitions ? fmt::format("{}", repetitions) : fmt::format("{} to {}", repetitions, most));
            }
        }
    }

private:
    [[noreturn]] void fail(std::size_t cell, const std::string& found, const std::string& allowed) const {
        throw InputError(file_, cells_.at(cell).at("cell").get<std::string>(), found, allowed);
    }

    void check_row(const OrderedJson& row, std::size_t cell) {
        const std::size_t index = row.at("repetition_index");
        if (!indices_.at(cell).insert(index).second) {
            fail(cell, fmt::format("sample {} twice", index), "each sample once");
        }
        if (!(row.at("real_time").get<double>() > 0)) {
            fail(cell, fmt::format("sample {} with a time of {}", index, row.at("real_time").dump()), "a time above 0");
        }
        const auto [sample, fault] = read_sample(row);
        if (!fault.empty()) {
            fail(cell, fmt::format("sample {} with {}", index, fault), "what a render can leave");
        }
        counted_[{cells_.at(cell).at("cell").get<std::string>(), index}] = seed_and_film(sample);
        if (cells_.at(cell).at("status") != "failed") {  // the film of a failed cell may be wrong and is not checked
            check_film(sample, cell, index);
        }
    }

    // Reads a sample from a result file, with a description of what is wrong with it.
    static std::pair<Sample, std::string> read_sample(const OrderedJson& json) {
        try {
            const Sample sample = sample_of_result(Json(json));
            return {sample, fault_of_sample(sample)};
        } catch (const WrongFact& wrong) {
            return {Sample(), wrong.what()};
        }
    }
    static Json seed_and_film(const Sample& sample) { return {sample.seed, sample.film_hash}; }

    // Checks a replaced sample: it must have the seed and the film of the sample that replaced it.
    void check_retaken(const OrderedJson& retake) {
        const std::string name = retake.at("cell");
        const std::size_t index = retake.at("repetition_index");
        const auto counted = counted_.find({name, index});
        if (counted == counted_.end()) {
            throw InputError(file_, name, fmt::format("sample {} taken again, and not there", index),
                             "samples that are there");
        }
        const auto [sample, fault] = read_sample(retake.at("sample"));
        if (!fault.empty()) {
            throw InputError(file_, name, fmt::format("sample {} before it was taken again with {}", index, fault),
                             "what a render can leave");
        }
        if (const Json mine = seed_and_film(sample); mine != counted->second) {
            throw InputError(
                file_, name,
                fmt::format("sample {} before it was taken again with seed and film {}", index, mine.dump()),
                counted->second.dump());
        }
    }

    void check_film(const Sample& sample, std::size_t number, std::size_t index) {
        const OrderedJson& cell = cells_.at(number);
        const bool is_prepared = cell.contains("film_hash") && cell.contains("instrumented") &&
                                 cell.at("instrumented").value("spp", 0) == cell.at("spp");
        if (index == 0 && is_prepared && sample.film_hash != cell.at("film_hash")) {
            fail(number, fmt::format("sample 0 with the film \"{}\"", sample.film_hash), cell.at("film_hash").dump());
        }
        if (cell.at("claim") != "bitwise") {
            return;
        }
        std::string group = std::to_string(sample.seed);
        for (const char* key : {"scene", "scene_hash", "backend", "resolution", "depth", "spp"}) {
            group += "/" + cell.at(key).dump();
        }
        const auto [first, is_first] = films_.try_emplace(group, sample.film_hash, number);
        if (const auto& [hash, owner] = first->second; sample.film_hash != hash) {
            fail(number, fmt::format("sample {} with the film \"{}\"", index, sample.film_hash),
                 fmt::format("\"{}\", the film of the same seed in {}", hash,
                             cells_.at(owner).at("cell").get<std::string>()));
        }
    }

    const std::string& file_;
    const OrderedJson& result_;
    const OrderedJson& cells_;
    std::vector<std::set<std::size_t>> indices_;                        // indices of a cell's samples so far, by cell
    std::map<std::pair<std::string, std::size_t>, Json> counted_;       // seed and film hash by cell and sample index
    std::map<std::string, std::pair<std::string, std::size_t>> films_;  // a bitwise group's first film and its cell
};

}  // namespace

void check_result(const std::string& file, const OrderedJson& result) { ResultChecker(file, result).check(); }

}  // namespace pt
