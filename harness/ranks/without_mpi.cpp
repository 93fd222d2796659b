// Replaces mpi.cpp in a build without MPI: every function except `is_built` throws.
#include <stdexcept>

#include "harness/ranks/mpi.h"

namespace pt::mpi {

namespace {
[[noreturn]] void refuse() { throw std::logic_error("this build has no MPI"); }
}  // namespace

bool is_built() { return false; }
Ranks start() { refuse(); }
void finish() { refuse(); }
std::string broadcast(const std::string&) { refuse(); }
std::vector<std::string> gather(const std::string&) { refuse(); }
void barrier() { refuse(); }
void add_to_rank_0(std::span<std::int64_t>) { refuse(); }

}  // namespace pt::mpi
