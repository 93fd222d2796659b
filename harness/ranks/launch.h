// Reads from environment variables how an MPI launcher started this process: Open MPI's mpirun, or a PMI server
// (MPICH's mpiexec, srun --mpi=pmi2 and --mpi=pmix).
#pragma once

#include <functional>
#include <string>

namespace pt {

struct Launch {
    int rank = 0;
    int count = 1;
    int local_rank = 0;   // rank of this process among those on its host
    int local_count = 1;  // number of ranks on this process's host
    bool operator==(const Launch&) const = default;
};

// Determines rank and rank count from environment variables; `variable(NAME)` is a variable's value, or null. Without
// complete information the process counts as a single one.
Launch launch_from(const std::function<const char*(const char*)>& variable);

// The value of CUDA_VISIBLE_DEVICES that gives a rank a GPU of its own where several ranks share a host; `visible` is
// its present value, or null. Empty: leave the variable alone, because there is one rank or the launcher assigned GPUs.
std::string own_gpu(const Launch& launch, const char* visible);

}  // namespace pt
