// The results of a cell's instrumented pass: stage times, counters and properties of the image. None of it counts as a
// timing.
#pragma once

#include "harness/bench/facts/cell.h"
#include "harness/bench/suite.h"

namespace pt {

// Adds the results of the instrumented pass to the facts of a cell.
void add_facts(CellFacts& facts, const Cell& cell, const RenderResult& result);

}  // namespace pt
