// Expands the arguments of `ptbench stability` into tasks: each is a case at a parameter point with a variant.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "harness/stability/evaluate.h"

namespace pt {

struct StabilityRequest {
    std::vector<std::string> cases, families;  // names of cases and of families; if both are empty, every case is run
    std::vector<std::string> values;           // "NAME=VALUE" of the only point; empty: the cases' points
    std::vector<std::string> axes;             // "AXIS=CHOICE,CHOICE"; empty: the standard variants
    std::uint64_t seed = 1;
    std::uint64_t paths = 0;
    bool quick = false;
};

// The cases that the options --case name, in their order, then those of the families that --family names, in the
// catalogue's order. Like all functions of this file, throws InputError.
std::vector<const stability::Case*> chosen_cases(const StabilityRequest& request);

// The variants for a command without --axis: every precision, arithmetic and robustness with the plainest integrator,
// and the other integrators in single precision, all with the generic kernel. The kernels that findings time are added
// later, for each case (variants_of_case).
std::vector<Variant> asked_variants(const StabilityRequest& request, Backend backend);

// The variants to run with a case, without duplicates: `variants`, each also with the case's estimators (unless --axis
// names their axis), and the plainest one with accelerators and builders. Without --axis also the kernels that findings
// time on a GPU (harness/stability/timed_variants.h), and two of these for each estimator and accelerator.
std::vector<Variant> variants_of_case(const std::vector<Variant>& variants, const stability::Case& stiff_case,
                                      const StabilityRequest& request, Backend backend);

// All tasks of a call of `ptbench stability`, grouped by case.
std::vector<stability::Task> all_tasks(const StabilityRequest& request, Backend backend);

}  // namespace pt
