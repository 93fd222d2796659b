// Puts the results of a run's shards together to what one run would have written.
#pragma once

#include <string>
#include <vector>

#include "harness/bench/shard.h"
#include "harness/json_reader.h"

namespace pt {

struct ShardResult {
    std::string file;
    Shard shard;
    std::vector<std::size_t> positions;  // of its cells in the whole run
    nlohmann::ordered_json result;
};

// Every shard of one run, in their order. Throws InputError for a file that is none, an unfinished, missing or second
// shard, and one of another machine, build, scene or command (what differs).
std::vector<ShardResult> read_shards(const std::vector<std::string>& files);

struct Merged {
    nlohmann::ordered_json result;
    // Files to copy, each from and to: the images that cells name, beside the new result as they were beside the old.
    std::vector<std::pair<std::string, std::string>> copies;
};

// Rows and cells in the order of the whole run. What is a machine's own and a shard's own (host, date, command, load)
// is under ptbench.shards; the context is the first one's.
Merged merge(const std::vector<ShardResult>& shards, const std::string& out, const std::string& command_line);

}  // namespace pt
