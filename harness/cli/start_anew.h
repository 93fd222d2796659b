// Restarts ptbench with another environment, since libgomp and Google Benchmark read theirs before main. By default a
// waiting thread of libgomp spins for milliseconds, on the core that the awaited thread may need: beside other jobs a
// render of 0.02 s then takes seconds.
#pragma once

namespace pt {

// Restarts the program in this process with shorter spinning (below a millisecond, or none in commands that time
// nothing) and without the variables that Google Benchmark takes for flags; `run` names on stderr those that were set.
// Returns if the environment needs no change, as after a restart, or if a restart fails. Throws InputError if
// OMP_NUM_THREADS is no number of threads.
void start_anew(char** argv);

}  // namespace pt
