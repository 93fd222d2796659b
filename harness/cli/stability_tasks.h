// What a call of `ptbench stability` asks for: of cases, points and variants the tasks.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "harness/stability/evaluate.h"

namespace pt {

struct StabilityRequest {
    std::vector<std::string> cases, families;  // neither: every case
    std::vector<std::string> values;           // "NAME=VALUE", for the one point; none: the cases' points
    std::vector<std::string> axes;             // "AXIS=CHOICE,CHOICE"; none: the standard variants
    std::uint64_t seed = 1;
    std::uint64_t paths = 0;
    bool quick = false;
};

// The cases that a call asks for, in its order, then in the catalogue's. Throws InputError, as all functions here.
std::vector<const stability::Case*> chosen_cases(const StabilityRequest& request);

// The variants of a call that names no axis: every precision, arithmetic and robustness with the plainest integrator,
// and the other integrators in single precision, all by the general kernel. What is timed is added by case
// (variants_of_case).
std::vector<Variant> asked_variants(const StabilityRequest& request, Backend backend);

// The variants, and each with the estimators that the case asks for unless the call named their axis; likewise the
// plainest one with accelerators and builders. Where no axis is named, also the kernels that findings time on a GPU
// (harness/stability/timed_variants.h), and some of those with each estimator and each accelerator. Each once.
std::vector<Variant> variants_of_case(const std::vector<Variant>& variants, const stability::Case& stiff_case,
                                      const StabilityRequest& request, Backend backend);

// The tasks that a call asks for, case after case.
std::vector<stability::Task> all_tasks(const StabilityRequest& request, Backend backend);

}  // namespace pt
