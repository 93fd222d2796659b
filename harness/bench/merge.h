// Merges the results of a run's shards into the result that an undivided run would have written.
#pragma once

#include <string>
#include <vector>

#include "harness/bench/shard.h"
#include "harness/json_reader.h"

namespace pt {

struct ShardResult {
    std::string file;
    Shard shard;
    std::vector<std::size_t> positions;  // positions of the shard's cells in the whole run
    nlohmann::ordered_json result;
};

// Reads the results of all shards of a run, sorted by shard. Throws InputError for a file that is no shard's result, an
// unfinished, missing or duplicate shard, and one of another machine, build, scene or command (with the difference).
std::vector<ShardResult> read_shards(const std::vector<std::string>& files);

struct Merged {
    nlohmann::ordered_json result;
    // Image files to copy, as pairs of source (beside a shard's result) and target (beside the merged result).
    std::vector<std::pair<std::string, std::string>> copies;
};

// Merges shards; rows and cells are in the order of the whole run. What belongs to one machine or shard (host, date,
// command, load) goes to ptbench.shards; the context is that of the first shard.
Merged merge(const std::vector<ShardResult>& shards, const std::string& out, const std::string& command_line);

}  // namespace pt
