// The result file: Google Benchmark's JSON (context, one row per sample, aggregates), which Google Benchmark's tools
// can read, and a "ptbench" object for what rows cannot hold: axes, claims, hashes, live paths, stage times, and
// variants that did not apply.
#pragma once

#include "harness/bench/facts/comparison.h"
#include "harness/bench/journal.h"
#include "harness/bench/suite.h"

namespace pt {

struct RunFacts {
    std::string command_line;
    std::string suite;
    std::string date;  // time at which the run ended, in ISO 8601
    Backend backend = Backend::cpu;
    bool completed = true;
    int repetitions = 1;
    int most_retakes = 0;  // largest number of retakes per cell
    RunRecord run = {};    // identity of the run, without the sessions, which the journal has
    std::vector<ComparisonFacts> comparisons = {};
};

struct Aggregates {
    double mean, median, stddev, cv;  // stddev and cv (stddev / mean) of a single value: 0
};
// Mean, median, standard deviation and coefficient of variation of some values. Precondition: there is at least one.
Aggregates aggregate(std::vector<double> values);

// Formats a JSON document of rows: every member of an object and every array element begins a line, and an array
// element stays on one line. Full indentation would make a result a third larger.
std::string rows_on_lines(const nlohmann::ordered_json& value);

// Counts a run's samples that are too unreliable to show a difference: other processes took CPU time, a CPU quota was
// used up, or the clock was low.
struct Disturbance {
    std::size_t samples = 0;
    std::size_t disturbed = 0;  // samples with a falsified time or a low clock
    std::size_t contended = 0;  // samples disturbed by other processes only
    std::size_t throttled = 0;  // samples disturbed by a used-up CPU quota
    std::size_t low_clock = 0;
    std::size_t clock_unknown = 0;
};
Disturbance disturbance_of(const Plan& plan, const Journal& journal);
// The disturbance in words, as "disturbed: 3 of 54 samples (other processes 2, low clock 1)".
std::string in_words(const Disturbance& disturbance);

// The text of the result file, in which each study says what it compares (with_questions). Throws InputError if the
// journal lacks a cell's facts or errors.
std::string result_json(const Plan& plan, const Suite& suite, const Journal& journal, const RunFacts& facts);
// Checks, before a run continues with a journal, that a run can have written it; an error found only at the end would
// have cost the whole run. Throws InputError.
void check_journal(const Plan& plan, const Journal& journal);

}  // namespace pt
