// Verifies the films of `ptbench verify`: every variant on every scene against its claim, in one or several processes.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "harness/cli/verify_arguments.h"
#include "harness/workers.h"

namespace pt {

// The scenes that `ptbench verify` names, and for each scene the variants to verify.
struct FilmsToVerify {
    Backend backend = Backend::cpu;
    std::vector<Scene> scenes;
    std::vector<std::vector<Variant>> variants;
};

// The resolution, "WxH", of the larger film that one variant of each choice is verified on.
std::string size_of_large_films();

// The number of processes that check films: 1 on a CPU, where every render uses all processors already, and several on
// a GPU, where small films mostly wait for launches and the host; each process takes device memory of its own.
std::size_t processes_for_films(const VerifyArguments& arguments);

// Whether several processes check films. They are forked before the backend is known and may stay idle.
bool uses_processes(const VerifyArguments& arguments, Backend backend);

// Forks processes that check films for `verify_films`. When first asked, a process calls `prepared`, which must return
// the films that are passed to `verify_films`; `arguments` must outlive the processes.
Workers film_checkers(std::size_t count, const VerifyArguments& arguments, std::function<FilmsToVerify()> prepared);

// Verifies all variants, by the workers or, without workers, in this process, and prints a line for each variant and
// each reason why variants do not apply. The output does not depend on the number of workers.
Tally verify_films(const FilmsToVerify& films, const VerifyArguments& arguments, Workers* workers);

}  // namespace pt
