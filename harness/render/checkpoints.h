// A render in parts, from checkpoint to checkpoint: how long the parts are, and what happens between them.
#pragma once

#include "harness/render/renderer.h"

namespace pt {

// A part of a render: the samples that it takes over those of the parts before it, which took `done`.
struct RenderPart {
    std::uint32_t done = 0;
    std::uint32_t samples = 1;  // a pixel
};

// One part a checkpoint; without checkpoints one part. Throws std::logic_error unless the checkpoints increase from 1
// or more and end with the request's samples.
std::vector<RenderPart> parts_of(const RenderRequest& request);

// Whether a variant's film has other bits if its render stops on the way: random numbers that follow the order of a
// queue, whose batches end there, or sums in single precision, which begin anew.
bool stops_change_film(const Variant& variant, Backend backend);

// Whether somebody looks at the film between two parts.
bool is_shown(const RenderRequest& request);

// Hands the state after `part` to the request's callback, if it is shown.
void report_checkpoint(const RenderRequest& request, const RenderPart& part, RenderResult& result);

}  // namespace pt
