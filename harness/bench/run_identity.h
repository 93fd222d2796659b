// What makes two runs one: a run goes on, is found to be done, or is put together from shards only where all of this is
// equal.
#pragma once

#include "harness/bench/facts/run.h"
#include "harness/bench/shard.h"

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
RunIdentity identity_of(const Plan& whole, const RunSettings& settings);

// The part of a run's identity that a result file keeps: lists as hashes, and as its identity the hash of all but the
// host's name and the shard. It has no positions and no sessions yet.
RunRecord record_of(const RunIdentity& identity);

}  // namespace pt
