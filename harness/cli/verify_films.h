// The films of `ptbench verify`: every variant of every scene is held to its claim, in this process or by several.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "harness/cli/verify_arguments.h"
#include "harness/workers.h"

namespace pt {

// A call's scenes, and for each the variants that are held to their claims there.
struct FilmsToVerify {
    Backend backend = Backend::cpu;
    std::vector<Scene> scenes;
    std::vector<std::vector<Variant>> variants;
};

// The size of the second, larger film of each choice, "WxH".
std::string size_of_large_films();

// The number of processes that check films. On a CPU one is enough, since every render has all processors already. On a
// GPU its small films are mostly waiting for launches and for the host; each process takes device memory for itself.
std::size_t processes_for_films(const VerifyArguments& arguments);

// Whether films are checked by several processes. Those are forked before the backend is known, and may stay idle.
bool uses_processes(const VerifyArguments& arguments, Backend backend);

// Processes that check films for `verify_films`. Those that are used call `prepared`, which must give what the call
// itself verifies, while the call is at its own; `arguments` must outlive them.
Workers film_checkers(std::size_t count, const VerifyArguments& arguments, std::function<FilmsToVerify()> prepared);

// Holds all variants to their claims, by the workers or, where there are none, in this process, and prints a line for
// each and, scene by scene, what does not apply. Lines and their order do not depend on the number of workers.
Tally verify_films(const FilmsToVerify& films, const VerifyArguments& arguments, Workers* workers);

}  // namespace pt
