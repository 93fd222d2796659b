// A render whose samples are split over all ranks. The film is the sum of theirs, in 64-bit integers: the bits of one
// process's, whatever the number of ranks.
#pragma once

#include "harness/json_reader.h"
#include "harness/render/renderer.h"

namespace pt {

// What several ranks add to a render's facts; of one rank `count` is 1 and all else 0.
struct RankFacts {
    int count = 1;
    double slowest_ms = 0;         // a rank's own wall time, without the reduction
    double fastest_ms = 0;         // the same, of ranks that had samples
    double reduce_ms = 0;          // from the moment at which all ranks have rendered to the film on rank 0
    double neighbours_cpu_ms = 0;  // CPU time that ranks of rank 0's host took, besides itself
};

struct RankedRender {
    RenderResult result;  // wall_ms and device_ms: slowest_ms and reduce_ms together; cpu_ms: of all ranks
    RankFacts ranks;
};

// Why a variant's film would have other bits if its samples were split; empty: it would not.
std::string why_not_split(const Variant& variant, Backend backend);

// Renders on all ranks; to be called on rank 0. With one rank it is `render` itself. Each rank counts its own work and
// holds it to the variant's claim. Throws what `render` throws, on whatever rank, and InputError where the film would
// have other bits, or a rank reads another scene.
RankedRender render_on_ranks(const Scene& scene, const RenderRequest& request);

// Throws InputError unless every rank runs on a machine of rank 0's kind, so that times are of one.
void require_equal_machines(Backend backend);

// Does on the other ranks what rank 0 asks for, until it ends; returns the exit code.
int serve_rank_0();
// Ends the other ranks; to be called on rank 0, once, at the end.
void end_ranks(int exit_code);

}  // namespace pt
