// Shards: parts of a run for several equal machines. Cells whose times or errors are compared stay in one shard, so
// that no comparison within a scene and setting is made across two machines.
#pragma once

#include <string>
#include <vector>

#include "harness/bench/suite.h"

namespace pt {

struct Shard {
    std::uint32_t index = 1;  // number of this shard, from 1 to `count`
    std::uint32_t count = 1;  // number of shards; 1: the run is not divided

    bool is_whole() const { return count == 1; }
    std::string name() const;  // "2/4"
};

// Parses a shard, "2/4" for the second of four. Throws InputError.
Shard parse_shard(const std::string& text);

// Groups the cells of a plan that must stay in one shard, as positions in the plan: cells with the same scene, backend,
// resolution, depth and spp, and cells that share a reference. Ordered by the first cell of each group.
std::vector<std::vector<std::size_t>> groups_of(const Plan& plan);

// The positions in the plan of a shard's cells, increasing. Groups are distributed greedily, the largest (pixels times
// samples) first, each to the shard with the least work. Throws InputError for more shards than groups.
std::vector<std::size_t> positions_of(const Plan& plan, const Shard& shard);
// A plan with only the cells at these positions of `plan`, and its whole list of variants that do not apply.
Plan part_of(const Plan& plan, const std::vector<std::size_t>& positions);

}  // namespace pt
