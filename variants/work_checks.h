// What compactions and sorts must have done by the end of a render, told from its counters. At a path's last possible
// segment nothing is sorted before shading or compacted after it: no later stage would gain.
#pragma once

#include "variants/descriptor.h"

namespace pt {

// Every path is taken out by a compaction or ends in the last segment.
inline std::string compacted_every_bounce(const WorkCounters& work, std::uint64_t) {
    if (work.compactions != work.bounces - work.last_bounces) {
        return std::to_string(work.compactions) + " compactions in " + std::to_string(work.bounces) + " bounces, " +
               std::to_string(work.last_bounces) + " of them last ones";
    }
    if (work.compacted_away + work.last_paths != work.paths) {
        return std::to_string(work.compacted_away) + " paths taken out and " + std::to_string(work.last_paths) +
               " ended in the last segment, of " + std::to_string(work.paths);
    }
    return "";
}

inline std::string sorted_every_bounce(const WorkCounters& work, std::uint64_t) {
    return work.sorts == work.bounces - work.last_bounces ? "" : "did not sort in every bounce but the last";
}

}  // namespace pt
