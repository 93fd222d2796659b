// Wrappers of the few MPI calls that ptbench makes, over all ranks. A waiting rank sleeps, so that it takes no CPU time
// from a rendering one on the same host; only `barrier` and `add_to_rank_0`, which are timed, poll.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "harness/ranks/ranks.h"

namespace pt::mpi {

// Whether this build has MPI. Otherwise no other function of this header may be called.
bool is_built();

// Starts MPI and returns this process's rank and how many ranks there are.
Ranks start();
void finish();

// Sends the text of rank 0 to all ranks and returns it on each.
std::string broadcast(const std::string& text);
// Collects the texts of all ranks on rank 0, by rank; returns an empty list on other ranks.
std::vector<std::string> gather(const std::string& text);

void barrier();
// Adds up arrays element by element over all ranks; rank 0 gets the sum, on other ranks `values` is unchanged.
void add_to_rank_0(std::span<std::int64_t> values);

}  // namespace pt::mpi
