// The identity of a run: a run is resumed, counted as done already, or merged from shards only if identities are equal.
#pragma once

#include "harness/bench/facts/run.h"
#include "harness/bench/shard.h"

namespace pt {

struct RunSettings {
    std::string suite;
    Backend backend = Backend::cpu;
    std::uint64_t seed = 1;
    int repetitions = 1;
    int most_repetitions = 1;  // limit of samples per cell where open verdicts may get more
    Shard shard = {};
};

// The identity of a run: machine, build, host name, the settings, and the hash of every scene, all cells and all
// references of the whole plan (not only of the shard).
RunIdentity identity_of(const Plan& whole, const RunSettings& settings);

// The part of a run's identity that a result file keeps: hashes instead of lists, and a hash of everything except the
// host name and the shard. The members `positions` and `sessions` stay empty.
RunRecord record_of(const RunIdentity& identity);

}  // namespace pt
