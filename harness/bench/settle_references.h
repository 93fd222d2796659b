// Between preparation and timing: references are made as accurate as the errors that the cells will have ask for.
#pragma once

#include <string>

#include "harness/bench/error_book.h"
#include "harness/bench/run_journal.h"
#include "harness/interrupt.h"

namespace pt {

// Cells that ask for more than their task's most_spp allows are refused, in the journal and on stderr. Throws
// InputError, with the name of the result file, where samples in the journal were compared with another reference.
void settle_references(const Plan& plan, const std::string& result_file, RunJournal& journal, ErrorBook& errors,
                       const Interrupt& interrupt);

}  // namespace pt
