// How many threads parallel loops have in a process where several processes share a machine.
#pragma once

#include <cstddef>

namespace pt {

// Threads for the parallel loops of each of `processes` processes that share this one's processors, at least one.
// OpenMP threads wait for each other by spinning: more of them than processors take up to a hundred times as long.
int share_of_threads(std::size_t processes);

// Sets the number of threads of this process's parallel loops.
void use_threads(int threads);

}  // namespace pt
