#include "harness/bench/result_check.h"

#include <cmath>
#include <map>
#include <set>
#include <vector>

#include <fmt/format.h>

namespace pt {

namespace {

using OrderedJson = nlohmann::ordered_json;

// How far a device's clock may be from the host's: crystals differ by 1e-4 at most.
constexpr double clocks_differ = 1e-3;

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
        if (const std::string fault = fault_of_sample(Json(row)); !fault.empty()) {
            fail(cell, fmt::format("sample {} with {}", index, fault), "what a render can leave");
        }
        if (row.contains("film_hash") && row.contains("pt_seed")) {
            counted_[{cells_.at(cell).at("cell").get<std::string>(), index}] = {row.at("pt_seed"), row.at("film_hash")};
        }
        if (row.contains("film_hash") && cells_.at(cell).at("status") != "failed") {  // that it differs may be why
            check_film(row, cell, index);
        }
    }

    // A sample whose place another took: of the same seed, and so with the same film.
    void check_retaken(const OrderedJson& retake) {
        const std::string name = retake.at("cell");
        const std::size_t index = retake.at("repetition_index");
        const Json sample(retake.at("sample"));
        const auto counted = counted_.find({name, index});
        if (counted == counted_.end()) {
            throw InputError(file_, name, fmt::format("sample {} taken again, and not there", index),
                             "samples that are there");
        }
        if (const std::string fault = fault_of_sample(sample); !fault.empty()) {
            throw InputError(file_, name, fmt::format("sample {} before it was taken again with {}", index, fault),
                             "what a render can leave");
        }
        const Json mine{sample.at("pt_seed"), sample.at("film_hash")};
        if (mine != counted->second) {
            throw InputError(
                file_, name,
                fmt::format("sample {} before it was taken again with seed and film {}", index, mine.dump()),
                counted->second.dump());
        }
    }

    void check_film(const OrderedJson& row, std::size_t number, std::size_t index) {
        const OrderedJson& cell = cells_.at(number);
        const bool is_prepared = cell.contains("film_hash") && cell.contains("instrumented") &&
                                 cell.at("instrumented").value("spp", 0) == cell.at("spp");
        if (index == 0 && is_prepared && row.at("film_hash") != cell.at("film_hash")) {
            fail(number, "sample 0 with the film " + row.at("film_hash").dump(), cell.at("film_hash").dump());
        }
        if (cell.at("claim") != "bitwise" || !row.contains("pt_seed")) {
            return;
        }
        std::string group = row.at("pt_seed").dump();
        for (const char* key : {"scene", "scene_hash", "backend", "resolution", "depth", "spp"}) {
            group += "/" + cell.at(key).dump();
        }
        const auto [first, is_first] = films_.try_emplace(group, row.at("film_hash").get<std::string>(), number);
        if (const auto& [hash, owner] = first->second; row.at("film_hash") != hash) {
            fail(number, fmt::format("sample {} with the film {}", index, row.at("film_hash").dump()),
                 fmt::format("\"{}\", the film of the same seed in {}", hash,
                             cells_.at(owner).at("cell").get<std::string>()));
        }
    }

    const std::string& file_;
    const OrderedJson& result_;
    const OrderedJson& cells_;
    std::vector<std::set<std::size_t>> indices_;                        // of each cell's samples
    std::map<std::pair<std::string, std::size_t>, Json> counted_;       // seed and film, by cell and index
    std::map<std::string, std::pair<std::string, std::size_t>> films_;  // the first of a group, and its cell
};

}  // namespace

std::string fault_of_sample(const Json& sample) {
    std::map<std::string, double> numbers;
    for (const auto& [key, value] : sample.items()) {
        const bool is_number = key == "cpu_ms" || (key.starts_with("pt_") && !value.is_array());
        if (is_number && (!value.is_number() || !std::isfinite(value.get<double>()))) {
            return fmt::format("{} {}", key, describe(value));
        }
        if (is_number) {
            numbers[key] = value.get<double>();
        }
    }
    for (const char* key : {"pt_wall_ms", "pt_device_ms", "pt_end_to_end_ms"}) {
        if (numbers.contains(key) && !(numbers[key] > 0)) {
            return fmt::format("{} {}, not above 0", key, numbers[key]);
        }
    }
    const double wall = numbers.contains("pt_wall_ms") ? numbers["pt_wall_ms"] : NAN;
    if (numbers.contains("pt_device_ms") && numbers["pt_device_ms"] > wall * (1 + clocks_differ)) {
        return fmt::format("pt_device_ms {} above its pt_wall_ms {}", numbers["pt_device_ms"], wall);
    }
    if (numbers.contains("pt_end_to_end_ms") && numbers["pt_end_to_end_ms"] < wall) {
        return fmt::format("pt_end_to_end_ms {} below its pt_wall_ms {}", numbers["pt_end_to_end_ms"], wall);
    }
    return "";
}

void check_result(const std::string& file, const OrderedJson& result) { ResultChecker(file, result).check(); }

}  // namespace pt
