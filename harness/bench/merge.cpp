#include "harness/bench/merge.h"

#include <algorithm>
#include <filesystem>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "harness/bench/comparisons.h"
#include "harness/bench/result_check.h"
#include "harness/bench/result_file.h"
#include "harness/machine/run_context.h"
#include "harness/say.h"

namespace pt {

namespace {

using OrderedJson = nlohmann::ordered_json;

constexpr const char* a_shard = "a result of `ptbench run --shard`";

// The facts that must be equal in all shards of a run.
Json common_of(const OrderedJson& result) {
    Json machine = Json::object();
    for (const auto& [key, value] : result.at("context").items()) {
        if (!is_own_of_a_shard(key)) {
            machine[key] = value;
        }
    }
    const OrderedJson& own = result.at("ptbench");
    Json run = own.at("run");
    for (const char* key : {"shard", "positions", "sessions"}) {
        run.erase(key);
    }
    return {{"context", machine},
            {"run", run},
            {"studies", Json(own.at("studies"))},
            {"baselines", Json(own.at("baselines"))},
            {"not_applicable", Json(own.at("not_applicable"))}};
}

ShardResult read_shard(const std::string& file) {
    ShardResult shard{.file = file, .shard = {}, .positions = {}, .result = {}};
    const std::string text = read_file(file, largest_result);
    (void)parse_json(text, file);
    shard.result = OrderedJson::parse(text);
    const OrderedJson::json_pointer place("/ptbench/run/shard");
    if (!shard.result.contains(place) || !shard.result.at(place).is_string()) {
        throw InputError(file, "$.ptbench.run.shard", "no shard of a run", a_shard);
    }
    shard.shard = parse_shard(shard.result.at(place));
    const std::string status = shard.result.at("context").value(CallContext::status_key, "");
    if (status != "completed") {
        throw InputError(file, std::string("$.context.") + CallContext::status_key, "\"" + status + "\"",
                         "\"completed\"; go on with the shard's own command and --resume");
    }
    shard.positions = shard.result.at("ptbench").at("run").at("positions").get<std::vector<std::size_t>>();
    if (shard.positions.size() != shard.result.at("ptbench").at("cells").size()) {
        throw InputError(file, "$.ptbench.run.positions", fmt::format("{} of them", shard.positions.size()),
                         "one a cell");
    }
    for (const OrderedJson& row : shard.result.at("benchmarks")) {
        if (row.at("family_index").get<std::size_t>() >= shard.positions.size()) {
            throw InputError(file, "$.benchmarks", "family_index " + row.at("family_index").dump(), "a cell's number");
        }
    }
    check_result(file, shard.result);
    return shard;
}

// Calls `read`, which reads a shard's result, and turns a JSON exception (another program or an editor changed the
// file) into an InputError that names the file.
template <class Read>
auto guarded(const std::string& file, const Read& read) {
    try {
        return read();
    } catch (const nlohmann::detail::exception& error) {
        throw InputError(file, "$", error.what(), a_shard);
    }
}

void check_same_run(const std::vector<ShardResult>& shards) {
    const ShardResult& first = shards.front();
    const Json common = guarded(first.file, [&] { return common_of(first.result); });
    for (const ShardResult& shard : shards) {
        const std::string other = difference(common, guarded(shard.file, [&] { return common_of(shard.result); }));
        if (!other.empty()) {
            throw InputError(shard.file, "shard " + shard.shard.name(),
                             "a part of another run than that of " + first.file + " (" + other + ")",
                             "shards of one run on equal machines");
        }
        if (shard.shard.count != first.shard.count) {
            throw InputError(shard.file, "shard " + shard.shard.name(), "one of " + std::to_string(shard.shard.count),
                             fmt::format("shards of {}, as {}", first.shard.count, first.file));
        }
    }
}

// Removes shards that were given twice under different file names. Precondition: shards are sorted by index.
void drop_copies(std::vector<ShardResult>& shards) {
    const auto is_copy = [](const ShardResult& kept, const ShardResult& next) {
        const bool is_one = kept.shard.index == next.shard.index && kept.result == next.result;
        if (is_one) {
            say("ptbench: {} is {} once more, and counts once\n", one_line(next.file), one_line(kept.file));
        }
        return is_one;
    };
    shards.erase(std::unique(shards.begin(), shards.end(), is_copy), shards.end());
}

// Checks that every shard of the run is present. Precondition: shards are of one run and sorted by index.
void check_complete(const std::vector<ShardResult>& shards) {
    for (std::size_t i = 1; i < shards.size(); ++i) {
        if (shards[i].shard.index == shards[i - 1].shard.index) {
            throw InputError(shards[i].file, "shard " + shards[i].shard.name(),
                             "the shard that " + shards[i - 1].file + " is", "each shard once");
        }
    }
    std::vector<std::string> missing;
    for (std::uint32_t index = 1; index <= shards.front().shard.count; ++index) {
        if (std::none_of(shards.begin(), shards.end(), [&](const auto& s) { return s.shard.index == index; })) {
            missing.push_back(Shard{index, shards.front().shard.count}.name());
        }
    }
    if (!missing.empty()) {
        throw InputError(
            "merge", "shards",
            fmt::format("{} of {}, without {}", shards.size(), shards.front().shard.count, fmt::join(missing, ", ")),
            "every shard of the run");
    }
    std::set<std::size_t> positions;
    std::size_t cells = 0;
    for (const ShardResult& shard : shards) {
        cells += shard.positions.size();
        positions.insert(shard.positions.begin(), shard.positions.end());
    }
    const std::size_t whole = shards.front().result.at("ptbench").at("run").at("cells");
    if (cells != whole || positions.size() != whole || *positions.rbegin() != whole - 1) {
        throw InputError("merge", "shards", fmt::format("{} cells at {} places", cells, positions.size()),
                         fmt::format("the run's {} cells, each once", whole));
    }
}

std::filesystem::path images_of(const std::string& result_file) {
    return std::filesystem::path(result_file).stem().string() + "_images";
}

// Renames an image from the shard's image folder into that of `out`, and records the file to copy.
std::string moved(const OrderedJson& name, const ShardResult& shard, const std::string& out, Merged& merged) {
    const std::filesystem::path old = name.get<std::string>();
    if (old.is_absolute() || old.parent_path() != images_of(shard.file)) {
        throw InputError(shard.file, "$.ptbench.cells", "an image " + name.dump(),
                         "one in " + images_of(shard.file).string());
    }
    const std::filesystem::path fresh = images_of(out) / old.filename();
    merged.copies.emplace_back((std::filesystem::path(shard.file).parent_path() / old).string(),
                               (std::filesystem::path(out).parent_path() / fresh).string());
    return fresh.string();
}

OrderedJson cell_of(OrderedJson cell, const ShardResult& shard, const std::string& out, Merged& merged) {
    const OrderedJson::json_pointer place("/convergence/images");
    if (cell.contains(place)) {
        OrderedJson& images = cell[place];
        images["reference"] = moved(images.at("reference"), shard, out, merged);
        for (OrderedJson& name : images.at("by_spp")) {
            name = moved(name, shard, out, merged);
        }
    }
    cell["shard"] = shard.shard.name();
    return cell;
}

// The facts that differ between shards (such as host and date), which the merged result keeps in ptbench.shards.
OrderedJson shard_json(const ShardResult& shard) {
    OrderedJson json{{"shard", shard.shard.name()}, {"cells", shard.positions.size()}};
    for (const auto& [key, value] : shard.result.at("context").items()) {
        if (is_own_of_a_shard(key)) {
            json[key] = value;
        }
    }
    return json;
}

OrderedJson merged_context(const std::vector<ShardResult>& shards, const std::string& command_line) {
    OrderedJson context = shards.front().result.at("context");
    std::vector<std::string> hosts;
    std::string date;
    for (const ShardResult& shard : shards) {
        const std::string host = shard.result.at("context").at(BenchmarkContext::host_name_key);
        if (std::find(hosts.begin(), hosts.end(), host) == hosts.end()) {
            hosts.push_back(host);
        }
        date = std::max(date, shard.result.at("context").at(CallContext::date_key).get<std::string>());
    }
    context[CallContext::date_key] = date;  // date at which the last shard ended
    context[BenchmarkContext::host_name_key] = fmt::format("{}", fmt::join(hosts, ", "));
    context[CallContext::command_line_key] = command_line;
    context.erase(CallContext::rank_hosts_key);  // hosts of the MPI ranks are listed for each shard, in ptbench.shards
    return context;
}

OrderedJson merged_run(const std::vector<ShardResult>& shards) {
    OrderedJson run = shards.front().result.at("ptbench").at("run");
    run.erase("shard");
    run.erase("positions");
    run["sessions"] = OrderedJson::array();
    for (const ShardResult& shard : shards) {
        for (OrderedJson session : shard.result.at("ptbench").at("run").at("sessions")) {
            session["shard"] = shard.shard.name();
            run["sessions"].push_back(std::move(session));
        }
    }
    return run;
}

// For each cell of the whole run, the shard that holds it, and the cell's number in that shard.
using Places = std::vector<std::pair<const ShardResult*, std::size_t>>;

Places places_of(const std::vector<ShardResult>& shards) {
    Places places(shards.front().result.at("ptbench").at("run").at("cells").get<std::size_t>());
    for (const ShardResult& shard : shards) {
        for (std::size_t i = 0; i < shard.positions.size(); ++i) {
            places[shard.positions[i]] = {&shard, i};
        }
    }
    return places;
}

void add_rows(OrderedJson& rows, const ShardResult& shard, std::size_t number, std::size_t family) {
    for (const OrderedJson& row : shard.result.at("benchmarks")) {
        if (row.at("family_index") == number) {
            rows.push_back(row);
            rows.back()["family_index"] = family;
        }
    }
}

// The samples of all shards that retakes replaced.
OrderedJson merged_retakes(const std::vector<ShardResult>& shards) {
    OrderedJson samples = OrderedJson::array();
    std::size_t most = 0;
    for (const ShardResult& shard : shards) {
        const OrderedJson& retakes = shard.result.at("ptbench").at("retakes");
        most = std::max(most, retakes.at("most_per_cell").get<std::size_t>());
        samples.insert(samples.end(), retakes.at("samples").begin(), retakes.at("samples").end());
    }
    return {{"most_per_cell", most}, {"samples", samples}};
}

std::vector<Study> studies_of(const OrderedJson& own) {
    std::vector<Study> studies;
    for (const OrderedJson& json : own.at("studies")) {
        Study& study = studies.emplace_back();
        study.name = json.at("name");
        study.compares = json.at("compares");
        study.along = json.at("along");
        if (json.at("type") == "convergence") {
            study.convergence.emplace();
        }
    }
    return studies;
}

// The verdicts on the cells of all shards. They are computed again, because a cell's baseline may be in another shard.
OrderedJson merged_comparisons(const OrderedJson& rows, const OrderedJson& own) {
    const ComparedRun run = compared_run(rows, own.at("cells"), own.at("baselines"));
    OrderedJson comparisons = OrderedJson::array();
    for (const Comparison& comparison : comparisons_of(run, studies_of(own))) {
        comparisons.push_back(comparison.facts());
    }
    return comparisons;
}

Merged merge_parsed(const std::vector<ShardResult>& shards, const std::string& out, const std::string& command_line) {
    Merged merged;
    OrderedJson rows = OrderedJson::array(), cells = OrderedJson::array(), parts = OrderedJson::array();
    const Places places = places_of(shards);
    for (std::size_t family = 0; family < places.size(); ++family) {
        const auto& [shard, number] = places[family];
        cells.push_back(cell_of(shard->result.at("ptbench").at("cells")[number], *shard, out, merged));
        add_rows(rows, *shard, number, family);
    }
    mark_low_clocks(rows);
    for (const ShardResult& shard : shards) {
        parts.push_back(shard_json(shard));
    }
    OrderedJson own = shards.front().result.at("ptbench");
    own["run"] = merged_run(shards);
    own["cells"] = std::move(cells);
    if (own.contains("retakes")) {  // either the results of all shards have retakes, or none
        own["retakes"] = merged_retakes(shards);
    }
    if (own.contains("comparisons")) {  // results of older programs have no comparisons
        own["comparisons"] = merged_comparisons(rows, own);
    }
    own["shards"] = std::move(parts);
    merged.result = {{"context", merged_context(shards, command_line)}, {"benchmarks", rows}, {"ptbench", own}};
    return merged;
}

}  // namespace

std::vector<ShardResult> read_shards(const std::vector<std::string>& files) {
    std::vector<ShardResult> shards;
    for (const std::string& file : files) {
        shards.push_back(guarded(file, [&] { return read_shard(file); }));
    }
    check_same_run(shards);
    std::stable_sort(shards.begin(), shards.end(),
                     [](const ShardResult& a, const ShardResult& b) { return a.shard.index < b.shard.index; });
    drop_copies(shards);
    guarded("merge", [&] {
        check_complete(shards);
        return 0;
    });
    return shards;
}

Merged merge(const std::vector<ShardResult>& shards, const std::string& out, const std::string& command_line) {
    return guarded("merge", [&] { return merge_parsed(shards, out, command_line); });
}

}  // namespace pt
