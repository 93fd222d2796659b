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

// This process's rank and how many there are.
Ranks start();
void finish();

// Rank 0's text, on every rank.
std::string broadcast(const std::string& text);
// Every rank's text by rank, on rank 0; elsewhere nothing.
std::vector<std::string> gather(const std::string& text);

void barrier();
// On rank 0 the sums over all ranks; elsewhere the values stay.
void add_to_rank_0(std::span<std::int64_t> values);

}  // namespace pt::mpi
