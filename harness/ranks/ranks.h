// The MPI ranks of a ptbench command: several processes if `mpirun -n N` or `srun` started it, otherwise one. Rank 0
// works like a single process; the others render the samples that it assigns (render_on_ranks.h) and exit with its
// code.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace pt {

struct Ranks {
    int rank = 0;
    int count = 1;
    std::vector<std::string> hosts = {};  // host names by rank; on rank 0 of several ranks only
};

// The MPI ranks of this command. MPI is not initialised unless a launcher started several processes.
const Ranks& ranks();

// The name of a machine with the number of ranks if there are several: "nvidia-h200-4-ranks".
std::string on_ranks(const std::string& machine);

// Runs `program`, which must not throw, on rank 0 (or in a single process) while other ranks serve it, and returns its
// exit code on every rank. To be called before any thread or output. Throws InputError on rank 0 if this build has no
// MPI; returns exit_bad_input if the ranks run different builds.
int run_on_ranks(const std::function<int()>& program);

}  // namespace pt
