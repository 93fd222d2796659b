// The few calls of MPI that ptbench makes, between all ranks. They wait asleep, but for `barrier` and `add_to_rank_0`,
// whose time counts: a rank that waits takes no processor from one that renders on the same host.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "harness/ranks/ranks.h"

namespace pt::mpi {

// Whether this build has MPI. Without it nothing below may be called.
bool is_built();

// Starts MPI and returns this process's rank and how many ranks there are.
Ranks start();
void finish();

// Sends rank 0's text to every rank, and returns it there.
std::string broadcast(const std::string& text);
// Collects every rank's text on rank 0, by rank; elsewhere the result is empty.
std::vector<std::string> gather(const std::string& text);

void barrier();
// Sums values over all ranks on rank 0; elsewhere they stay.
void add_to_rank_0(std::span<std::int64_t> values);

}  // namespace pt::mpi
