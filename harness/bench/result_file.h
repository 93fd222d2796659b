// The result file: Google Benchmark's JSON (context, one row a sample, aggregates), which its own tools read, and a
// "ptbench" object with what rows cannot hold: axes, claims, hashes, live paths, stage times, what did not apply and
// why.
#pragma once

#include "harness/bench/facts/comparison.h"
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
    int most_retakes = 0;  // a cell
    RunRecord run = {};    // less its sessions
    std::vector<ComparisonFacts> comparisons = {};
};

struct Aggregates {
    double mean, median, stddev, cv;  // stddev and cv are 0 for one value
};
// Mean, median and spread of some values. Precondition: there is at least one.
Aggregates aggregate(std::vector<double> values);

// A document of rows as text: each member of an object and each element of an array begins a line, and an element is
// on that line whole. Indented, a result is a third larger.
std::string rows_on_lines(const nlohmann::ordered_json& value);

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
// The disturbance in words, as "disturbed: 3 of 54 samples (other processes 2, low clock 1)".
std::string in_words(const Disturbance& disturbance);

// The text of the result file. Each study of the suite says what it compares (with_questions). Throws InputError where
// the journal lacks a cell's own line or errors.
std::string result_json(const Plan& plan, const Suite& suite, const Journal& journal, const RunFacts& facts);
// Checks that a run can have left the journal, before another goes on with it: found at its end, that would have been
// for nothing. Throws InputError.
void check_journal(const Plan& plan, const Journal& journal);

}  // namespace pt
