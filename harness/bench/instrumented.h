// What a cell's instrumented pass says: where the time goes, what was counted and what the image is; never a result.
#pragma once

#include "harness/bench/suite.h"

namespace pt {

Json facts_of(const Cell& cell, const RenderResult& result);

}  // namespace pt
