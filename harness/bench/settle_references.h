// Between preparation and timing, makes the reference images as accurate as the expected errors of the cells demand.
#pragma once

#include <string>

#include "harness/bench/error_book.h"
#include "harness/bench/run_journal.h"
#include "harness/interrupt.h"

namespace pt {

// Fails cells whose reference image would need more samples than its most_spp, in the journal and on stderr. Throws
// InputError, with the result file's name, if samples in the journal were compared with another reference.
void settle_references(const Plan& plan, const std::string& result_file, RunJournal& journal, ErrorBook& errors,
                       const Interrupt& interrupt);

}  // namespace pt
