#include "harness/bench/run_identity.h"

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include "harness/ranks/machine_context.h"
#include "variants/fnv1a.h"

namespace pt {

namespace {

std::string hash_of(const Json& json) {
    const std::string text = json.dump();
    return fmt::format("{:016x}", fnv1a(text));
}

}  // namespace

RunIdentity identity_of(const Plan& whole, const RunSettings& settings) {
    RunIdentity identity{.backend = std::string(to_string(settings.backend)),
                         .host_name = benchmark::SystemInfo::Get().name,
                         .machine = Json(machine_context(settings.backend)),
                         .repetitions = settings.repetitions,
                         .seed = settings.seed,
                         .suite = settings.suite};
    for (const Cell& cell : whole.cells) {
        identity.cells.push_back(cell.name);
        identity.scenes[cell.scene->name] = cell.scene->hash;
        if (cell.convergence) {
            const ReferenceTask& task = cell.convergence->reference;
            identity.references[cell.name] = fmt::format("{} of scene {}, variance {}, at most {} spp a half",
                                                         task.name(), task.scene->hash, task.variance, task.most_spp);
        }
    }
    if (settings.most_repetitions > settings.repetitions) {
        identity.most_repetitions = settings.most_repetitions;
    }
    if (!settings.shard.is_whole()) {
        identity.shard = settings.shard.name();
    }
    return identity;
}

RunRecord record_of(const RunIdentity& identity) {
    RunIdentity common = identity;
    common.shard.reset();
    Json shared(common);
    shared.erase(RunIdentity::host_name_key);
    return {.identity = hash_of(shared),
            .seed = identity.seed,
            .repetitions = identity.repetitions,
            .scenes = identity.scenes,
            .references = hash_of(identity.references),
            .cells = identity.cells.size(),
            .cells_hash = hash_of(identity.cells),
            .most_repetitions = identity.most_repetitions,
            .shard = identity.shard};
}

}  // namespace pt
