// Short names of cells for progress displays: variant, scene, and only those settings that differ within the run. Files
// and filters use the full name (Cell::name).
#pragma once

#include <string>

#include "harness/bench/suite.h"

namespace pt {

class ShortNames {
public:
    explicit ShortNames(const Plan& plan);
    // The short name of a cell, as "wavefront layout=soa, cornell_open, depth 4".
    std::string of(const Cell& cell) const;

private:
    bool sizes_differ_ = false, depths_differ_ = false, spps_differ_ = false;
};

}  // namespace pt
