// A part of a run for one of several equal machines. Cells whose times or errors are compared with each other stay in
// one shard, so that no comparison within a scene and setting is between two machines.
#pragma once

#include <string>
#include <vector>

#include "harness/bench/suite.h"

namespace pt {

struct Shard {
    std::uint32_t index = 1;  // from 1
    std::uint32_t count = 1;  // 1: the whole run

    bool is_whole() const { return count == 1; }
    std::string name() const;  // "2/4"
};

// Reads a shard, "2/4" for the second of four; throws InputError.
Shard parse_shard(const std::string& text);

// The groups of a plan, each as the positions of its cells: cells of one scene, backend, resolution, depth and spp, and
// cells that share a reference, are together. In the order of their first cells.
std::vector<std::vector<std::size_t>> groups_of(const Plan& plan);

// The positions in the plan of a shard's cells, increasing. The largest groups (pixels times samples) are placed first,
// each into the shard that has the least so far. Throws InputError if there are more shards than groups.
std::vector<std::size_t> positions_of(const Plan& plan, const Shard& shard);
// The plan with these cells only; what does not apply stays.
Plan part_of(const Plan& plan, const std::vector<std::size_t>& positions);

}  // namespace pt
