// The processes of one call: several where `mpirun -n N` or `srun` started it, else one. Rank 0 does what a lone
// process does; the others render the samples that it hands them (render_on_ranks.h) and end with its exit code.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace pt {

struct Ranks {
    int rank = 0;
    int count = 1;
    std::vector<std::string> hosts = {};  // by rank; of several ranks, and on rank 0 alone
};

// The ranks of this call: one, and MPI is not touched, unless this process was started as one of several.
const Ranks& ranks();

// A machine's name, with the number of ranks where there are several: "nvidia-h200-4-ranks".
std::string on_ranks(const std::string& machine);

// Calls `program` where a lone process or rank 0 is to run it, and serves it on the others; returns what it returned,
// on every rank. `program` throws nothing. Throws InputError on rank 0 where this build has no MPI, or where the ranks
// are not of one build. Before any thread and any output.
int run_on_ranks(const std::function<int()>& program);

}  // namespace pt
