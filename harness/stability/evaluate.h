// Evaluates a case at a point with a variant: what came out, what should have, how far off it may be, and whether it
// is. A failure is looked at twice: only one that independent samples confirm counts.
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
    std::uint64_t paths = 0;  // of a rendering; 0: as many as the case asks for
};

// passed, failed: as they say. known_limit: failed, as the case says that it does. not_applicable: could not be asked.
// broken: no number came out (an exception, or samples that were no numbers).
enum class Status { passed, failed, known_limit, not_applicable, broken };
std::string_view to_string(Status status);

struct Row {
    Status status = Status::not_applicable;
    std::string reason;  // of every status but passed: why
    Measurement measurement;
    double error = 0;          // by which `measured` misses what the relation asks for, 0 if it does not
    double allowed = 0;        // tolerance, and four standard errors
    bool is_estimate = false;  // of samples that differ
    int looks = 1;             // independent renders that it took to say so
    std::uint64_t paths = 0;
    std::uint64_t rays = 0;
    std::uint64_t unfinished_walks = 0;
    FilmFaults faults;
    HealthCounters health;  // of an integrator that inspects; else no paths
    std::string film_hash;  // of a single batch; empty: there are several, or none
    double seconds = 0;     // of rendering, or of the direct check

    // The error as a share of what is allowed; not finite where nothing is allowed but something missed.
    double error_over_allowed() const { return error == 0 ? 0 : error / allowed; }
};

// Why the task cannot be evaluated; empty: it can.
std::string not_applicable(const Task& task);

// One row a quantity, or a single one that says why there is none. Throws nothing that a render throws.
std::vector<Row> evaluate(const Task& task);

// The text of every scene that evaluating the task renders, with the variant, as far as its kernels depend on it: what
// is to be compiled beforehand. None of a direct check.
std::vector<std::pair<std::string, Variant>> renders_of(const Task& task);

// The reference integrator with the generic kernel in exact arithmetic, every other axis at its plainest.
Variant plainest_variant(Backend backend);

// Whether ptbench claims that this passes: robust kernels in arithmetic that the rounding bounds hold in, with our own
// test of triangles.
bool must_pass(const Variant& variant, Backend backend);

Json to_json(const Task& task, const Row& row);
Json to_json(const Task& task, const std::vector<Row>& rows);
Json to_json(const Case& stiff_case);
Json to_json(const Values& values);

}  // namespace pt::stability
