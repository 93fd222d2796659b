// What a cell's instrumented pass says: where the time goes, what was counted and what the image is; never a result.
#pragma once

#include "harness/bench/facts/cell.h"
#include "harness/bench/suite.h"

namespace pt {

// Adds what the pass found to what is known of the cell.
void add_facts(CellFacts& facts, const Cell& cell, const RenderResult& result);

}  // namespace pt
