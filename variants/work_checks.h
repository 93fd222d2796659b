// Checks by a render's counters that compactions and sorts did their work. At a path's last possible segment nothing is
// sorted before shading or compacted after it: no later stage would gain.
#pragma once

#include <cstddef>
#include <stdexcept>

#include "variants/descriptor.h"

namespace pt {

// Checks the number of paths in a queue after `stage`: `now` may not exceed `before`, the number that the stage was
// given, since slots further back hold no path. Throws std::runtime_error.
inline void check_count_after(const char* stage, std::size_t before, std::size_t now) {
    if (now > before) {
        throw std::runtime_error("the " + std::string(stage) + " returned a count of " + std::to_string(now) +
                                 " paths in play, allowed: at most " + std::to_string(before) +
                                 ", as many as it was given");
    }
}

// Reports a compaction that missed a bounce: every path must be compacted away or end in the last segment. Empty: none.
inline std::string compacted_every_bounce(const WorkCounters& work, std::uint64_t) {
    if (work.compactions != work.bounces - work.last_bounces) {
        return std::to_string(work.compactions) + " compactions in " + std::to_string(work.bounces) + " bounces, " +
               std::to_string(work.last_bounces) + " of them last ones";
    }
    // compacted_away is a difference of counts: a compaction that adds paths makes it a number near 2^64.
    if (work.compacted_away > work.paths) {
        return std::to_string(0 - work.compacted_away) + " paths more in play after compactions than before them, of " +
               std::to_string(work.paths);
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
