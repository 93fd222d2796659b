// Evaluates a stability case at a point with a variant: the measured value, the exact value, the allowed error and the
// verdict. A failed estimate is measured again with independent samples, and only a second failure counts.
#pragma once

#include "harness/stability/case.h"

namespace pt::stability {

struct Task {
    const Case* stiff_case = nullptr;
    Values values;
    Backend backend = Backend::cpu;
    Variant variant;
    std::uint64_t seed = 1;
    bool is_quick = false;
    std::uint64_t paths = 0;  // paths per rendering; 0: as many as the case asks for
};

// The verdict on a row. known_limit: failed where the case predicts it. not_applicable: cannot be evaluated. broken: no
// valid number resulted (an exception, or faulty samples in the film).
enum class Status { passed, failed, known_limit, not_applicable, broken };
std::string_view to_string(Status status);

struct Row {
    Status status = Status::not_applicable;
    std::string reason;  // why the result row's status is not `passed`
    Measurement measurement;
    double error = 0;          // by how much `measured` violates the relation, or 0
    double allowed = 0;        // largest error allowed: tolerance plus four standard errors
    bool is_estimate = false;  // whether `measured` is a mean over batches of samples
    int looks = 1;             // number of independent measurements until the verdict
    std::uint64_t paths = 0;
    std::uint64_t rays = 0;
    std::uint64_t unfinished_walks = 0;
    FilmFaults faults;
    HealthCounters health;  // health counters; zero paths if the integrator keeps none
    std::string film_hash;  // film hash if there is a single batch; otherwise empty
    double seconds = 0;     // time in seconds of the renders or the direct check

    // The error as a share of the allowed error; infinite if nothing is allowed and there is an error.
    double error_over_allowed() const { return error == 0 ? 0 : error / allowed; }
};

// Says why a stability task cannot be evaluated; empty if it can.
std::string not_applicable(const Task& task);

// Evaluates a task: one row for each quantity, or a single row with the reason why there is none. Exceptions of a
// render become rows with status `broken`.
std::vector<Row> evaluate(const Task& task);

// The scene texts and variants of all renders of a task, as far as kernels depend on them, so that the kernels can be
// compiled beforehand. Empty for a direct check.
std::vector<std::pair<std::string, Variant>> renders_of(const Task& task);

// The reference integrator with the generic kernel in exact arithmetic; every other axis at its plainest.
Variant plainest_variant(Backend backend);

// Whether ptbench claims that stability cases pass with this variant: robust kernels, arithmetic with rounding bounds,
// and ptbench's own ray-triangle test.
bool must_pass(const Variant& variant, Backend backend);

Json to_json(const Task& task, const Row& row);
Json to_json(const Task& task, const std::vector<Row>& rows);
Json to_json(const Case& stiff_case);
Json to_json(const Values& values);

}  // namespace pt::stability
