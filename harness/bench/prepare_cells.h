// What comes before a cell's timed samples: its kernels are compiled, it is verified at a small size and takes its
// instrumented pass at its own.
#pragma once

#include "harness/bench/compile_ahead.h"
#include "harness/bench/error_book.h"
#include "harness/bench/film_ledger.h"
#include "harness/bench/progress.h"
#include "harness/bench/run_journal.h"
#include "harness/interrupt.h"

namespace pt {

// Prepares the cells that the journal does not know yet, until an interrupt. A cell that fails has its reason in the
// journal. `seed` is that of sample 0.
void prepare_cells(const Plan& plan, std::uint64_t seed, RunJournal& journal, FilmLedger& films, ErrorBook& errors,
                   const Interrupt& interrupt, Progress::Lines lines);

// The kernels of every cell, for those who compile them elsewhere (compile_for). The plan must outlive them.
std::vector<CompileTask> compilations_of(const Plan& plan);

}  // namespace pt
