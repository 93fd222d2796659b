// The results of a cell's instrumented pass: stage times, counters and image properties. They are not timed samples.
#pragma once

#include "harness/bench/facts/cell.h"
#include "harness/bench/suite.h"

namespace pt {

// Adds the results of the instrumented pass to the facts of a cell.
void add_facts(CellFacts& facts, const Cell& cell, const RenderResult& result);

}  // namespace pt
