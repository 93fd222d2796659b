// The result file: Google Benchmark's JSON (context, one row a sample, aggregates), which its own tools read, and a
// "ptbench" object with what rows cannot hold: axes, claims, hashes, live paths, stage times, what did not apply and
// why.
#pragma once

#include "harness/bench/journal.h"
#include "harness/bench/suite.h"

namespace pt {

struct RunFacts {
    std::string command_line;
    std::string suite;
    std::string date;  // ISO 8601, of the run's end
    Backend backend = Backend::cpu;
    bool completed = true;
    int repetitions = 1;
    int most_retakes = 0;                                           // a cell
    nlohmann::ordered_json run = nlohmann::ordered_json::object();  // ptbench.run (run_identity.h), less its sessions
};

struct Aggregates {
    double mean, median, stddev, cv;  // stddev and cv are 0 for one value
};
// Mean, median and spread of some values. Precondition: there is at least one.
Aggregates aggregate(std::vector<double> values);

// A document of rows as text: each member of an object and each element of an array begins a line, and an element is
// on that line whole. Indented, a result is a third larger.
std::string rows_on_lines(const nlohmann::ordered_json& value);

// Marks each sample's row whose clock was low, judged by the highest clock of all these rows.
void mark_low_clocks(nlohmann::ordered_json& rows);

// How many of a run's samples cannot be trusted with a difference: another process took CPU time, a quota of it was
// used up, or the clock was low.
struct Disturbance {
    std::size_t samples = 0;
    std::size_t disturbed = 0;  // any of them
    std::size_t contended = 0;  // by is_disturbed
    std::size_t throttled = 0;  // by is_disturbed, where a quota was used up
    std::size_t low_clock = 0;
    std::size_t clock_unknown = 0;
};
Disturbance disturbance_of(const Plan& plan, const Journal& journal);
// Whether another process or a quota took CPU time such that the sample's time may be wrong for it: on a GPU a busy
// host can only make a render longer than the device worked, or, where the render waits for the host within, longer on
// both clocks.
bool is_disturbed(const Json& sample, Backend backend);
// Whether a quota of CPU time was used up during the sample, so that its threads stood still.
bool is_throttled(const Json& sample);
// The disturbance in words, as "disturbed: 3 of 54 samples (other processes 2, low clock 1)".
std::string in_words(const Disturbance& disturbance);

// The text of the result file. Throws InputError if the journal holds what no run can have written there.
std::string result_json(const Plan& plan, const Suite& suite, const Journal& journal, const RunFacts& facts);
// Checks the journal as result_json does, before a run goes on with it: found at its end, the run would have been for
// nothing.
void check_journal(const Plan& plan, const Suite& suite, const Journal& journal);

}  // namespace pt
