// What the launcher of an MPI program says of this process in its environment: Open MPI's mpirun, or a PMI server's
// (MPICH's mpiexec, srun --mpi=pmi2 and --mpi=pmix).
#pragma once

#include <functional>
#include <string>

namespace pt {

struct Launch {
    int rank = 0;
    int count = 1;
    int local_rank = 0;   // on its host
    int local_count = 1;  // ranks of this host
    bool operator==(const Launch&) const = default;
};

// How the process was launched, by environment variables: `variable(NAME)` is a variable's value, or null. It is a lone
// process where nothing is said, or not all of it.
Launch launch_from(const std::function<const char*(const char*)>& variable);

// The GPU that a rank of several on a host has to itself, as CUDA_VISIBLE_DEVICES shall say it, given what that says
// now (null: nothing). Empty: to be left as it is, since the launcher gave each rank GPUs of its own.
std::string own_gpu(const Launch& launch, const char* visible);

}  // namespace pt
