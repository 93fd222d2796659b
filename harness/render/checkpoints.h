// Splits a render into parts that end at checkpoints, numbers of samples after which a callback sees the film.
#pragma once

#include "harness/render/renderer.h"

namespace pt {

// A part of a render: `samples` samples per pixel after the `done` samples of the parts before.
struct RenderPart {
    std::uint32_t done = 0;
    std::uint32_t samples = 1;  // samples per pixel in this part
};

// Returns one part for each checkpoint, or a single part without checkpoints. Throws std::logic_error unless the
// checkpoints increase from 1 or more and end with the request's samples.
std::vector<RenderPart> parts_of(const RenderRequest& request);

// Whether stopping a render at checkpoints changes the film's bits: with random numbers that follow the order of a
// queue, whose batches end at checkpoints, or with sums in single precision, which start anew.
bool stops_change_film(const Variant& variant, Backend backend);

// Whether the render request has a callback that looks at the film between two parts.
bool is_shown(const RenderRequest& request);

// Passes the state of the render after `part` to the request's callback, if it has one.
void report_checkpoint(const RenderRequest& request, const RenderPart& part, RenderResult& result);

}  // namespace pt
