// Prepares cells before their timed samples: compiles kernels, verifies each cell at a small size and runs its
// instrumented pass at full size.
#pragma once

#include "harness/bench/compile_ahead.h"
#include "harness/bench/error_book.h"
#include "harness/bench/film_ledger.h"
#include "harness/bench/progress.h"
#include "harness/bench/run_journal.h"
#include "harness/interrupt.h"

namespace pt {

// Prepares the cells that are not in the journal yet, until an interrupt. The reason of a failure goes to the journal.
// `seed` is the seed of sample 0.
void prepare_cells(const Plan& plan, std::uint64_t seed, RunJournal& journal, FilmLedger& films, ErrorBook& errors,
                   const Interrupt& interrupt, Progress::Lines lines);

// The kernels of every cell of a plan as tasks for compile_for. The plan must outlive the tasks.
std::vector<CompileTask> compilations_of(const Plan& plan);

}  // namespace pt
