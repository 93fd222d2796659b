// The results of a cell's instrumented pass: stage times, counters and image properties. They are not timed samples.
#pragma once

#include "harness/bench/facts/cell.h"
#include "harness/bench/suite.h"

namespace pt {

// Adds what the instrumented pass of a cell found to the cell's facts.
void add_facts(CellFacts& facts, const Cell& cell, const RenderResult& result);

}  // namespace pt
