// Renders with samples split over all MPI ranks. The film is the sum of the ranks' films in 64-bit integers, so it has
// the same bits for any number of ranks.
#pragma once

#include "harness/json_reader.h"
#include "harness/render/renderer.h"

namespace pt {

// Facts about a render on several ranks; on a single rank `count` is 1 and everything else 0.
struct RankFacts {
    int count = 1;
    double slowest_ms = 0;         // longest wall time of a rank, without the summing of films
    double fastest_ms = 0;         // shortest wall time of a rank with samples, without the summing of films
    double reduce_ms = 0;          // time to sum the films of the ranks, after all have rendered
    double neighbours_cpu_ms = 0;  // CPU time of the other ranks on rank 0's host
};

struct RankedRender {
    RenderResult result;  // wall time includes the summing of films; CPU time is that of all ranks
    RankFacts ranks;
};

// Says why a variant's film would depend on how its samples are split; empty if it would not.
std::string why_not_split(const Variant& variant, Backend backend);

// Renders on all ranks; to be called on rank 0. Without other ranks the function equals `render`. Each rank checks its
// work counts against the variant's claim. Throws what `render` throws on any rank, and InputError if splitting the
// samples would change the film or if a rank reads another scene.
RankedRender render_on_ranks(const Scene& scene, const RenderRequest& request);

// Throws InputError unless all ranks run on the same kind of machine, so that their times belong to one machine.
void require_equal_machines(Backend backend);

// Carries out the requests of rank 0 on another rank until rank 0 ends; returns the exit code.
int serve_rank_0();
// Ends the other ranks; to be called once, on rank 0 at the end.
void end_ranks(int exit_code);

}  // namespace pt
