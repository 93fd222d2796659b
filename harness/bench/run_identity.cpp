#include "harness/bench/run_identity.h"

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include "harness/ranks/machine_json.h"
#include "variants/fnv1a.h"

namespace pt {

namespace {

std::string hash_of(const Json& json) {
    const std::string text = json.dump();
    return fmt::format("{:016x}", fnv1a(text));
}

}  // namespace

Json identity_of(const Plan& whole, const RunSettings& settings) {
    Json cells = Json::array(), scenes = Json::object(), references = Json::object();
    for (const Cell& cell : whole.cells) {
        cells.push_back(cell.name);
        scenes[cell.scene->name] = cell.scene->hash;
        if (cell.convergence) {
            const ReferenceTask& task = cell.convergence->reference;
            references[cell.name] = fmt::format("{} of scene {}, variance {}, at most {} spp a half", task.name(),
                                                task.scene->hash, task.variance, task.most_spp);
        }
    }
    Json identity{{"machine", Json(machine_json(settings.backend))},
                  {"host_name", benchmark::SystemInfo::Get().name},
                  {"suite", settings.suite},
                  {"backend", to_string(settings.backend)},
                  {"seed", settings.seed},
                  {"repetitions", settings.repetitions},
                  {"scenes", scenes},
                  {"references", references},
                  {"cells", cells}};
    if (settings.most_repetitions > settings.repetitions) {
        identity["most_repetitions"] = settings.most_repetitions;
    }
    if (!settings.shard.is_whole()) {
        identity["shard"] = settings.shard.name();
    }
    return identity;
}

nlohmann::ordered_json run_json(const Json& identity) {
    Json common = identity;
    common.erase("host_name");
    common.erase("shard");
    nlohmann::ordered_json run{{"identity", hash_of(common)},
                               {"seed", identity.at("seed")},
                               {"repetitions", identity.at("repetitions")},
                               {"scenes", identity.at("scenes")},
                               {"references", hash_of(identity.at("references"))},
                               {"cells", identity.at("cells").size()},
                               {"cells_hash", hash_of(identity.at("cells"))}};
    if (identity.contains("most_repetitions")) {
        run["most_repetitions"] = identity.at("most_repetitions");
    }
    if (identity.contains("shard")) {
        run["shard"] = identity.at("shard");
    }
    return run;
}

}  // namespace pt
