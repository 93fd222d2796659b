// What a cell is called where people look on: its variant, its scene, and of its settings those that differ within the
// run. Files and filters have the whole name (Cell::name).
#pragma once

#include <string>

#include "harness/bench/suite.h"

namespace pt {

class ShortNames {
public:
    explicit ShortNames(const Plan& plan);
    // A cell's short name, as "wavefront layout=soa, cornell_open, depth 4".
    std::string of(const Cell& cell) const;

private:
    bool sizes_differ_ = false, depths_differ_ = false, spps_differ_ = false;
};

}  // namespace pt
