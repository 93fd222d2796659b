// libgomp and Google Benchmark read the environment before main. What they would read wrongly there, and how threads
// wait for each other, is set here, before the program starts once more: by libgomp's default a thread that waits spins
// for milliseconds, on the core that the one it waits for needs, and beside other jobs a render of 0.02 s takes
// seconds.
#pragma once

namespace pt {

// Starts the program anew, in this process, with threads that spin for less than a millisecond before they sleep, or in
// commands that measure nothing not at all, and without the variables that Google Benchmark takes for its flags; of
// those, `run` says on stderr which were set. Returns where the environment is so already (so after the new start too),
// and where there can be no new start. Throws InputError for an OMP_NUM_THREADS that is no number of threads.
void start_anew(char** argv);

}  // namespace pt
