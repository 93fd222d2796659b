// What makes two runs one: a run goes on, is found to be done, or is put together from shards only where all of this is
// equal.
#pragma once

#include "harness/bench/shard.h"
#include "harness/json_reader.h"

namespace pt {

struct RunSettings {
    std::string suite;
    Backend backend = Backend::cpu;
    std::uint64_t seed = 1;
    int repetitions = 1;
    int most_repetitions = 1;  // where more samples may be taken for open verdicts
    Shard shard = {};
};

// Machine, build, the host's name, the settings, and of the whole plan (whatever the shard) the content of every scene,
// every cell and every reference.
Json identity_of(const Plan& whole, const RunSettings& settings);

// The part of a run's identity that a result file keeps, under ptbench.run: lists as hashes, and "identity", the hash
// of all but the host's name and the shard.
nlohmann::ordered_json run_json(const Json& identity);

}  // namespace pt
