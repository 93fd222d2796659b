// How many threads parallel loops have where several processes share a machine.
#pragma once

#include <cstddef>

namespace pt {

// The share that each of so many processes has of the threads of this one's parallel loops: at least one. Threads of
// OpenMP wait for each other by spinning: more of them than processors take up to a hundred times as long.
int share_of_threads(std::size_t processes);

// From here on this process's parallel loops have so many threads.
void use_threads(int threads);

}  // namespace pt
