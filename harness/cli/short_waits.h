// Threads that wait for each other spin, by libgomp's default for milliseconds: beside other jobs a thread spins on the
// core that the one it waits for needs, and a render of 0.02 s takes seconds.
#pragma once

namespace pt {

// Starts the program anew, in this process, with threads that spin for less than a millisecond before they sleep, or in
// commands that measure nothing not at all: libgomp reads its environment before main. Returns where the environment
// says already how threads wait (so after the new start too), and where there can be no new start.
void shorten_waits(char** argv);

}  // namespace pt
