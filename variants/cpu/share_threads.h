// How many threads parallel loops have where several processes share a machine.
#pragma once

#include <cstddef>

namespace pt {

// From here on this process's parallel loops have its share of the threads that they would have had, at least one.
// Threads of OpenMP wait for each other by spinning: more of them than processors take up to a hundred times as long.
void share_threads(std::size_t processes);

}  // namespace pt
